// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "glissade/base/status.h"
#include "io/byte_source.h"

namespace glissade::internal {

/// Reads a table of numbers, plain or compressed, row by row: separated by commas, or by white
/// space (separator ' '). Empty lines and lines that start with # are skipped; white space around a
/// field is. The first thing that goes wrong is kept as status() = "path:line: what"; from then on
/// NextRow() is false and fields read as 0.
class CsvReader {
 public:
  static Result<CsvReader> Open(const std::string& path, char separator = ',');

  [[nodiscard]] bool ok() const { return status_.ok(); }
  [[nodiscard]] const Status& status() const { return status_; }
  /// Of the present row, from 1.
  [[nodiscard]] std::int64_t line() const { return line_; }
  /// The present row as it is, without white space around it.
  [[nodiscard]] std::string_view row() const { return row_; }
  /// Fails at the line of the present row; the first failure is kept.
  void Fail(const std::string& message, StatusCode code = StatusCode::kParseError);

  /// From here on "nan" and "inf" are numbers, too, and what is too large for a double is inf.
  void AllowNonFinite() { non_finite_ = true; }

  /// The next row; false at the end of the file and after a failure.
  bool NextRow();
  [[nodiscard]] int num_fields() const { return static_cast<int>(fields_.size()); }
  /// Fails unless the row has this many fields.
  void ExpectFields(int n, std::string_view what);
  /// A field of the present row as it is; empty where there is none.
  [[nodiscard]] std::string_view Text(int field) const {
    return field < num_fields() ? fields_[static_cast<std::size_t>(field)] : std::string_view();
  }
  /// Fails: expected so and so (of this kind), found that.
  void FailExpected(int field, std::string_view what, std::string_view rule);
  /// A field of the present row; fails where there is none, or where it is something else.
  double Number(int field, std::string_view what);
  void Numbers(int first, int n, double* to, std::string_view what);
  /// low <= x <= high.
  std::int64_t Integer(int field, std::int64_t low, std::int64_t high, std::string_view what);

 private:
  CsvReader() = default;
  friend class Result<CsvReader>;
  bool NextLine();

  std::string path_;
  char separator_ = ',';
  std::unique_ptr<ByteSource> source_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // not yet looked at
  bool source_ended_ = false;
  std::string_view text_;  // of the present line, fields cut off
  std::string_view row_;   // the same, whole
  std::vector<std::string_view> fields_;
  std::int64_t line_ = 0;
  bool non_finite_ = false;
  Status status_;
};

}  // namespace glissade::internal
