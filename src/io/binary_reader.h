// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "glissade/base/status.h"

namespace glissade::internal {

/// Reads a binary file, little endian, number by number, and knows the offset of each. The file is
/// taken as it is: no compression is looked for.
///
/// As with TextReader the first thing that goes wrong is kept, as "path:byte N: what"; from then on
/// every call does nothing and returns 0.
class BinaryReader {
 public:
  static Result<BinaryReader> Open(const std::string& path);

  [[nodiscard]] bool ok() const { return status_.ok(); }
  [[nodiscard]] const Status& status() const { return status_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Of the next byte.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }

  /// The first failure is kept.
  void Fail(std::uint64_t offset, std::string_view message);

  std::uint8_t Byte(std::string_view what);
  std::uint32_t Integer32(std::string_view what);
  std::uint64_t Integer64(std::string_view what);
  /// A finite number.
  double Number(std::string_view what);
  void Numbers(double* to, int n, std::string_view what);
  /// How many of something follow that take up at least so many bytes each: as many as the rest of
  /// the file has room for.
  std::uint64_t Count(std::uint64_t bytes_each, std::string_view what);
  /// Up to the next byte 0, which is taken and left out.
  std::string Text(std::string_view what);
  void ExpectEnd();

 private:
  struct Closes {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  BinaryReader() = default;
  friend class Result<BinaryReader>;
  /// The next `size` bytes as a number; 0 where there are fewer.
  std::uint64_t Take(int size, std::string_view what);
  bool Refill();

  std::string path_;
  std::unique_ptr<std::FILE, Closes> file_;
  std::vector<unsigned char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // not yet taken: [begin_, end_)
  std::uint64_t offset_ = 0, size_ = 0;
  Status status_;
};

}  // namespace glissade::internal
