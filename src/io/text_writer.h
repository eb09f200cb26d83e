// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "glissade/base/status.h"

namespace glissade::internal {

/// Where bytes go: a plain, gzip or bzip2 file.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  virtual bool Write(const char* data, std::size_t size) = 0;
  /// Everything is on its way to the disk; false if not.
  virtual bool Close() = 0;
};

/// Writes a text file, compressed if the name ends in .gz or .bz2; numbers with as many digits as
/// it takes to read back to the same bits.
///
/// The file appears whole or not at all: it is written beside its place and moved there by Close().
/// A writer destroyed before leaves nothing behind.
class TextWriter {
 public:
  static Result<TextWriter> Create(const std::string& path);
  TextWriter(TextWriter&&) noexcept = default;
  TextWriter& operator=(TextWriter&&) = delete;
  ~TextWriter();

  /// Words of a line are put one space apart.
  TextWriter& Word(std::string_view word);
  TextWriter& Number(double x);
  TextWriter& Numbers(const double* x, int n);
  TextWriter& Integer(std::int64_t x);
  void EndLine();
  /// A line of text as it is.
  void Line(std::string_view text);
  /// Bytes as they are, where a format is not text from here on.
  void Bytes(const void* data, std::size_t size);

  Status Close();

 private:
  TextWriter() = default;
  friend class Result<TextWriter>;
  void Flush();
  void Check(bool good);

  std::string path_;       // where it shall be
  std::string temporary_;  // where it is; empty where path_ is a device, written directly
  std::unique_ptr<ByteSink> sink_;
  std::string buffer_;
  bool in_line_ = false;
  bool failed_ = false;
  int why_ = 0;  // errno of the first failure
};

}  // namespace glissade::internal
