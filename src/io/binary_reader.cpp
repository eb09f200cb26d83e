// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/binary_reader.h"

#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace glissade::internal {

namespace {
constexpr std::size_t kBufferSize = std::size_t{1} << 16;
}

Result<BinaryReader> BinaryReader::Open(const std::string& path) {
  BinaryReader reader;
  reader.path_ = path;
  std::error_code error;
  errno = 0;
  if (std::filesystem::is_directory(path, error)) {
    errno = EISDIR;
  } else {
    reader.size_ = std::filesystem::file_size(path, error);
    errno = error.value();
    if (!error) reader.file_.reset(std::fopen(path.c_str(), "rb"));
  }
  if (reader.file_ == nullptr) {
    std::string message = path;
    message.append(": cannot be opened: ").append(std::strerror(errno != 0 ? errno : EIO));
    return Status(StatusCode::kIoError, message);
  }
  reader.buffer_.resize(kBufferSize);
  return reader;
}

void BinaryReader::Fail(std::uint64_t offset, std::string_view message) {
  if (!status_.ok()) return;
  std::string text = path_;
  text.append(":byte ").append(std::to_string(offset)).append(": ").append(message);
  status_ = Status(StatusCode::kParseError, text);
}

bool BinaryReader::Refill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  errno = 0;
  const std::size_t n = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
  if (n == 0 && std::ferror(file_.get()) != 0) {
    std::string message = path_;
    message.append(": cannot be read: ").append(std::strerror(errno != 0 ? errno : EIO));
    status_ = Status(StatusCode::kIoError, message);
  }
  end_ += n;
  return n > 0;
}

std::uint64_t BinaryReader::Take(int size, std::string_view what) {
  const auto wanted = static_cast<std::size_t>(size);
  while (ok() && end_ - begin_ < wanted) {
    if (Refill() || !ok()) continue;
    std::string message = "expected ";
    message.append(what).append(", found the end of the file");
    Fail(offset_, message);
  }
  if (!ok()) return 0;
  std::uint64_t x = 0;
  for (std::size_t k = 0; k < wanted; ++k)
    x |= static_cast<std::uint64_t>(buffer_[begin_ + k]) << (8 * k);
  begin_ += wanted;
  offset_ += wanted;
  return x;
}

std::uint8_t BinaryReader::Byte(std::string_view what) {
  return static_cast<std::uint8_t>(Take(1, what));
}

std::uint32_t BinaryReader::Integer32(std::string_view what) {
  return static_cast<std::uint32_t>(Take(4, what));
}

std::uint64_t BinaryReader::Integer64(std::string_view what) {
  return Take(8, what);
}

double BinaryReader::Number(std::string_view what) {
  const std::uint64_t at = offset_;
  const double x = std::bit_cast<double>(Take(8, what));
  if (std::isfinite(x)) return x;
  std::string message(what);
  Fail(at, message.append(" is not finite"));
  return 0.0;
}

void BinaryReader::Numbers(double* to, int n, std::string_view what) {
  for (int k = 0; k < n; ++k)
    to[k] = Number(what);
}

std::uint64_t BinaryReader::Count(std::uint64_t bytes_each, std::string_view what) {
  const std::uint64_t at = offset_;
  const std::uint64_t count = Take(8, what);
  const std::uint64_t left = size_ > offset_ ? size_ - offset_ : 0;
  if (!ok() || count <= left / bytes_each) return count;
  std::string message = std::to_string(count);
  message.append(" as ").append(what).append(", but ").append(std::to_string(left));
  Fail(at, message.append(" bytes are left in the file"));
  return 0;
}

std::string BinaryReader::Text(std::string_view what) {
  std::string text;
  while (ok()) {
    const auto c = static_cast<char>(Byte(what));
    if (c == '\0') break;
    text += c;
  }
  return text;
}

void BinaryReader::ExpectEnd() {
  if (!ok() || (begin_ == end_ && !Refill())) return;
  Fail(offset_, "expected the end of the file; are the counts right?");
}

}  // namespace glissade::internal
