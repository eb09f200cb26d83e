// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

namespace glissade::internal {

/// One line of a table: numbers with as few digits as read back to the same bits.
class CsvRow {
 public:
  explicit CsvRow(std::string_view separator = ", ") : separator_(separator) {}

  CsvRow& Number(double x) {
    char text[32];
    const auto [end, error] = std::to_chars(text, text + sizeof(text), x);
    static_cast<void>(error);  // the longest has 24 characters
    return Word(std::string_view(text, static_cast<std::size_t>(end - text)));
  }
  template <class List>
  CsvRow& Numbers(const List& x, int n) {
    for (int i = 0; i < n; ++i)
      Number(x[i]);
    return *this;
  }
  CsvRow& Integer(std::int64_t x) { return Word(std::to_string(x)); }
  CsvRow& Word(std::string_view word) {
    if (!text_.empty()) text_ += separator_;
    text_ += word;
    return *this;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string_view separator_;
  std::string text_;
};

}  // namespace glissade::internal
