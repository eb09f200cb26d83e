// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/bal_binary.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "io/text_reader.h"
#include "io/text_writer.h"

namespace glissade::internal {

namespace {

// The first byte is in no text, the rest shows where a file was carried as if it were one.
constexpr char kMagic[8] = {'\x89', 'B', 'B', 'A', 'L', '\r', '\n', '\x1a'};
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kByteOrder = 0x01020304;  // other bytes on a machine of the other order

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t byte_order;
  std::int64_t cameras;
  std::int64_t points;
  std::int64_t observations;
  std::uint64_t checksum;  // of all that follows
};
static_assert(sizeof(Header) == 48);

// Records of the file are those in memory.
static_assert(sizeof(VertexCameraBal) == 72 && std::is_trivially_copyable_v<VertexCameraBal>);
static_assert(sizeof(VertexPointXYZ) == 24 && std::is_trivially_copyable_v<VertexPointXYZ>);
static_assert(sizeof(BalObservation) == 24 && std::is_trivially_copyable_v<BalObservation>);

/// Of words of 8 bytes. A step is one to one in the word and in what was before, so no change of a
/// single word goes unnoticed, and of several about one in 2^64.
class Checksum {
 public:
  void Add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const char*>(data);
    for (std::size_t k = 0; k < size; k += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes + k, 8);
      sum_ = std::rotl((sum_ ^ word) * 0x9e3779b97f4a7c15u, 29);
    }
  }
  [[nodiscard]] std::uint64_t Value() const { return sum_; }

 private:
  std::uint64_t sum_ = 0;
};

std::int64_t Length(const Header& h) {
  return static_cast<std::int64_t>(sizeof(Header)) + 72 * h.cameras + 24 * h.points +
         24 * h.observations;
}

class Reader {
 public:
  Reader(ByteSource& source, const std::string& path) : source_(source), path_(path) {}

  /// False where the file ends before; then status() says so.
  bool Read(void* to, std::size_t size) {
    auto* bytes = static_cast<char*>(to);
    while (size > 0 && status_.ok()) {
      std::string why;
      const std::ptrdiff_t n = source_.Read(bytes, size, &why);
      if (n < 0) status_ = {StatusCode::kIoError, path_ + ": cannot be read: " + why};
      if (n == 0) Fail("ends before all is there");
      if (n <= 0) return false;
      bytes += n;
      size -= static_cast<std::size_t>(n);
    }
    return status_.ok();
  }
  /// A list, in parts: where the size of the file is not known its counts may be a lie, and memory
  /// is taken for what has come.
  template <class T>
  void Read(std::int64_t count, std::vector<T>* list) {
    list->reserve(ReserveFor(count, source_.Size() / static_cast<std::int64_t>(sizeof(T))));
    while (static_cast<std::int64_t>(list->size()) < count && status_.ok()) {
      const std::size_t before = list->size();
      const std::int64_t left = count - static_cast<std::int64_t>(before);
      list->resize(before + ReserveFor(left));
      T* const part = list->data() + before;
      const std::size_t size = (list->size() - before) * sizeof(T);
      if (Read(part, size)) checksum_.Add(part, size);
    }
  }
  void Fail(const char* what) {
    if (status_.ok()) status_ = {StatusCode::kParseError, path_ + ": binary BAL: " + what};
  }
  bool AtEnd() {
    char more = 0;
    std::string why;
    return source_.Read(&more, 1, &why) == 0;
  }
  [[nodiscard]] const Status& status() const { return status_; }
  [[nodiscard]] std::uint64_t checksum() const { return checksum_.Value(); }

 private:
  ByteSource& source_;
  const std::string& path_;
  Checksum checksum_;
  Status status_;
};

void CheckHeader(const Header& h, std::int64_t file_size, Reader* in) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (h.byte_order != kByteOrder) return in->Fail("written on a machine of another byte order");
  if (h.version != kVersion) return in->Fail("of a version that this program does not know");
  for (const std::int64_t count : {h.cameras, h.points, h.observations}) {
    if (count < 1 || count > kMost) return in->Fail("counts must be 1 to 2147483647");
  }
  if (file_size != 0 && file_size < Length(h)) return in->Fail("shorter than its counts say");
  if (file_size > Length(h)) return in->Fail("longer than its counts say");
}

}  // namespace

bool IsBalBinary(std::string_view first_bytes) {
  return first_bytes.size() >= sizeof(kMagic) &&
         std::memcmp(first_bytes.data(), kMagic, sizeof(kMagic)) == 0;
}

Result<BalProblem> ReadBalBinary(ByteSource& source, const std::string& path) {
  Reader in(source, path);
  Header header{};
  if (in.Read(&header, sizeof(header))) CheckHeader(header, source.Size(), &in);
  BalProblem problem;
  if (in.status().ok()) in.Read(header.cameras, &problem.cameras);
  if (in.status().ok()) in.Read(header.points, &problem.points);
  if (in.status().ok()) in.Read(header.observations, &problem.observations);
  if (in.status().ok() && in.checksum() != header.checksum) in.Fail("damaged (checksum)");
  if (in.status().ok() && !in.AtEnd()) in.Fail("longer than its counts say");
  if (!in.status().ok()) return in.status();
  if (const Status s = CheckBal(problem); !s.ok()) {
    return Status(StatusCode::kParseError, path + ": " + s.message());
  }
  return problem;
}

Status WriteBalBinary(const BalProblem& problem, const std::string& path) {
  auto writer = TextWriter::Create(path);
  if (!writer.ok()) return writer.status();
  TextWriter& out = writer.value();
  Checksum checksum;
  const auto for_all = [&](const auto& write) {
    write(problem.cameras.data(), problem.cameras.size() * sizeof(problem.cameras[0]));
    write(problem.points.data(), problem.points.size() * sizeof(problem.points[0]));
    write(problem.observations.data(),
          problem.observations.size() * sizeof(problem.observations[0]));
  };
  for_all([&](const void* data, std::size_t size) { checksum.Add(data, size); });
  Header header{};
  std::copy_n(kMagic, sizeof(kMagic), header.magic);
  header.version = kVersion;
  header.byte_order = kByteOrder;
  header.cameras = static_cast<std::int64_t>(problem.cameras.size());
  header.points = static_cast<std::int64_t>(problem.points.size());
  header.observations = static_cast<std::int64_t>(problem.observations.size());
  header.checksum = checksum.Value();
  out.Bytes(&header, sizeof(header));
  for_all([&](const void* data, std::size_t size) { out.Bytes(data, size); });
  return out.Close();
}

}  // namespace glissade::internal
