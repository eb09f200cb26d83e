// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "glissade/base/status.h"

namespace glissade::internal {

/// The bytes of a file, decompressed where it is gzip or bzip2.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Reads up to `size` bytes. Returns how many, 0 at the end, -1 on failure: then *why says what.
  virtual std::ptrdiff_t Read(char* to, std::size_t size, std::string* why) = 0;
  /// Bytes of the whole file; 0 where they are not known before (compressed, a pipe).
  [[nodiscard]] virtual std::int64_t Size() const { return 0; }
  /// Before anything has been read: how the file begins, at least 8 bytes if it has them. Empty
  /// where it is compressed.
  [[nodiscard]] virtual std::string_view FirstBytes() const { return {}; }
};

/// Opens a file. What it is (plain, gzip, bzip2) is told by its first bytes, not by its name.
Result<std::unique_ptr<ByteSource>> OpenByteSource(const std::string& path);

}  // namespace glissade::internal
