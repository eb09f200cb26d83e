// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/byte_source.h"

#include <bzlib.h>
#include <sys/stat.h>
#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>
#include <vector>

namespace glissade::internal {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 16;

/// The file's own bytes, chunk by chunk.
class RawFile {
 public:
  explicit RawFile(std::FILE* file) : file_(file), buffer_(kChunk) {}
  ~RawFile() { std::fclose(file_); }
  RawFile(const RawFile&) = delete;
  RawFile& operator=(const RawFile&) = delete;

  /// Makes at least `wanted` bytes available unless the file ends before. False on failure.
  bool Fill(std::size_t wanted, std::string* why) {
    if (end_ - begin_ >= wanted) return true;
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    while (end_ < wanted) {
      errno = 0;
      const std::size_t n = std::fread(buffer_.data() + end_, 1, kChunk - end_, file_);
      if (n == 0) {
        if (std::ferror(file_)) {
          *why = errno != 0 ? std::strerror(errno) : "read error";
          return false;
        }
        break;
      }
      end_ += n;
    }
    return true;
  }
  /// 0 where that cannot be told before it has been read.
  [[nodiscard]] std::int64_t Length() const {
    struct stat status {};
    if (fstat(fileno(file_), &status) != 0 || !S_ISREG(status.st_mode)) return 0;
    return static_cast<std::int64_t>(status.st_size);
  }
  [[nodiscard]] char* data() { return buffer_.data() + begin_; }
  [[nodiscard]] const char* data() const { return buffer_.data() + begin_; }
  [[nodiscard]] std::size_t size() const { return end_ - begin_; }
  void Consume(std::size_t n) { begin_ += n; }

 private:
  std::FILE* file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

class PlainSource final : public ByteSource {
 public:
  explicit PlainSource(std::unique_ptr<RawFile> file) : file_(std::move(file)) {}
  std::ptrdiff_t Read(char* to, std::size_t size, std::string* why) override {
    if (!file_->Fill(1, why)) return -1;
    const std::size_t n = size < file_->size() ? size : file_->size();
    std::memcpy(to, file_->data(), n);
    file_->Consume(n);
    return static_cast<std::ptrdiff_t>(n);
  }
  [[nodiscard]] std::int64_t Size() const override { return file_->Length(); }
  [[nodiscard]] std::string_view FirstBytes() const override {
    return {file_->data(), file_->size()};
  }

 private:
  std::unique_ptr<RawFile> file_;
};

bool IsGzip(const char* magic, std::size_t n) {
  return n >= 2 && magic[0] == '\x1f' && magic[1] == '\x8b';
}
bool IsBzip2(const char* magic, std::size_t n) {
  return n >= 4 && std::memcmp(magic, "BZh", 3) == 0 && magic[3] >= '1' && magic[3] <= '9';
}

/// Drives a decompressor over a file of one or more compressed streams put behind each other (as
/// `cat a.gz b.gz` and parallel compressors make them).
///
/// Codec: Start() and Stop() a stream; Step(in, in_size, out, out_size) moves the pointers and
/// returns kMore, kStreamEnd or kDamaged; IsStart(bytes, n) recognises another stream.
template <class Codec>
class CompressedSource final : public ByteSource {
 public:
  explicit CompressedSource(std::unique_ptr<RawFile> file) : file_(std::move(file)) {}
  ~CompressedSource() override {
    if (open_) codec_.Stop();
  }

  std::ptrdiff_t Read(char* to, std::size_t size, std::string* why) override {
    while (true) {
      if (!open_ && !NextStream(why)) return why->empty() ? 0 : -1;
      if (!file_->Fill(1, why)) return -1;
      const bool at_end = file_->size() == 0;
      std::size_t in = file_->size();
      std::size_t out = size;
      const auto outcome = codec_.Step(file_->data(), &in, to, &out);
      file_->Consume(in);
      if (outcome == Codec::kStreamEnd) {
        codec_.Stop();
        open_ = false;
      } else if (outcome == Codec::kDamaged) {
        return Failed("compressed data is damaged", why);
      } else if (at_end && out == 0) {
        return Failed("compressed data is cut short", why);
      }
      if (out > 0) return static_cast<std::ptrdiff_t>(out);
    }
  }

 private:
  static std::ptrdiff_t Failed(const char* message, std::string* why) {
    *why = message;
    return -1;
  }

  /// False at the end of the file (*why empty) and on failure.
  bool NextStream(std::string* why) {
    if (!file_->Fill(4, why)) return false;
    if (file_->size() == 0) return false;
    if (!Codec::IsStart(file_->data(), file_->size())) {
      *why = "bytes that do not belong there after the compressed data";
      return false;
    }
    if (!codec_.Start()) {
      *why = "the decompressor cannot be started";
      return false;
    }
    open_ = true;
    return true;
  }

  std::unique_ptr<RawFile> file_;
  Codec codec_;
  bool open_ = false;
};

struct GzipCodec {
  enum Outcome { kMore, kStreamEnd, kDamaged };
  z_stream stream{};

  static bool IsStart(const char* bytes, std::size_t n) { return IsGzip(bytes, n); }
  bool Start() {
    stream = {};
    return inflateInit2(&stream, 15 + 16) == Z_OK;  // 15: largest window, + 16: gzip only
  }
  void Stop() { inflateEnd(&stream); }
  Outcome Step(char* in, std::size_t* in_size, char* out, std::size_t* out_size) {
    stream.next_in = reinterpret_cast<Bytef*>(in);
    stream.avail_in = static_cast<uInt>(*in_size);
    stream.next_out = reinterpret_cast<Bytef*>(out);
    stream.avail_out = static_cast<uInt>(*out_size);
    const int code = inflate(&stream, Z_NO_FLUSH);
    *in_size -= stream.avail_in;
    *out_size -= stream.avail_out;
    if (code == Z_STREAM_END) return kStreamEnd;
    return code == Z_OK || code == Z_BUF_ERROR ? kMore : kDamaged;
  }
};

struct Bzip2Codec {
  enum Outcome { kMore, kStreamEnd, kDamaged };
  bz_stream stream{};

  static bool IsStart(const char* bytes, std::size_t n) { return IsBzip2(bytes, n); }
  bool Start() {
    stream = {};
    return BZ2_bzDecompressInit(&stream, 0, 0) == BZ_OK;
  }
  void Stop() { BZ2_bzDecompressEnd(&stream); }
  Outcome Step(char* in, std::size_t* in_size, char* out, std::size_t* out_size) {
    stream.next_in = in;
    stream.avail_in = static_cast<unsigned>(*in_size);
    stream.next_out = out;
    stream.avail_out = static_cast<unsigned>(*out_size);
    const int code = BZ2_bzDecompress(&stream);
    *in_size -= stream.avail_in;
    *out_size -= stream.avail_out;
    if (code == BZ_STREAM_END) return kStreamEnd;
    return code == BZ_OK ? kMore : kDamaged;
  }
};

}  // namespace

Result<std::unique_ptr<ByteSource>> OpenByteSource(const std::string& path) {
  errno = 0;
  std::FILE* raw = std::fopen(path.c_str(), "rb");
  if (raw == nullptr) {
    return Status(StatusCode::kIoError, path + ": cannot be opened: " + std::strerror(errno));
  }
  auto file = std::make_unique<RawFile>(raw);
  std::string why;
  if (!file->Fill(8, &why)) return Status(StatusCode::kIoError, path + ": cannot be read: " + why);
  std::unique_ptr<ByteSource> source;
  if (IsGzip(file->data(), file->size())) {
    source = std::make_unique<CompressedSource<GzipCodec>>(std::move(file));
  } else if (IsBzip2(file->data(), file->size())) {
    source = std::make_unique<CompressedSource<Bzip2Codec>>(std::move(file));
  } else {
    source = std::make_unique<PlainSource>(std::move(file));
  }
  return source;
}

}  // namespace glissade::internal
