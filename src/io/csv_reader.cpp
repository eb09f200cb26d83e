// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/csv_reader.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

#include "io/text_reader.h"

namespace glissade::internal {

namespace {

// A longer line is no row of numbers.
constexpr std::size_t kBufferSize = std::size_t{1} << 17;

std::string_view Trimmed(std::string_view text) {
  const auto space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && space(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && space(text.back()))
    text.remove_suffix(1);
  return text;
}

std::string_view WithoutPlus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  return word;
}

}  // namespace

Result<CsvReader> CsvReader::Open(const std::string& path, char separator) {
  auto source = OpenByteSource(path);
  if (!source.ok()) return source.status();
  CsvReader reader;
  reader.path_ = path;
  reader.separator_ = separator;
  reader.source_ = std::move(source).value();
  reader.buffer_.resize(kBufferSize);
  return reader;
}

void CsvReader::Fail(const std::string& message, StatusCode code) {
  if (!status_.ok()) return;
  status_ = Status(code, path_ + ":" + std::to_string(line_) + ": " + message);
  fields_.clear();
}

void CsvReader::FailExpected(int field, std::string_view what, std::string_view rule) {
  const bool there = field < num_fields();
  Fail("expected " + std::string(what) + " (" + std::string(rule) + "), found " +
       (there ? "'" + Printable(fields_[static_cast<std::size_t>(field)]) + "'"
              : std::string("the end of the line")));
}

bool CsvReader::NextLine() {
  if (!ok()) return false;
  std::size_t looked = 0;
  while (true) {
    const char* const from = buffer_.data() + begin_;
    const void* newline = std::memchr(from + looked, '\n', end_ - begin_ - looked);
    if (newline != nullptr) {
      const auto length = static_cast<std::size_t>(static_cast<const char*>(newline) - from);
      text_ = {from, length};
      begin_ += length + 1;
      ++line_;
      return true;
    }
    looked = end_ - begin_;
    if (source_ended_) {
      if (looked == 0) return false;
      text_ = {from, looked};  // a last line without its newline
      begin_ = end_;
      ++line_;
      return true;
    }
    std::memmove(buffer_.data(), from, looked);
    begin_ = 0;
    end_ = looked;
    if (end_ == buffer_.size()) {
      ++line_;
      Fail("a line of over " + std::to_string(kBufferSize) + " characters: not a table");
      return false;
    }
    std::string why;
    const std::ptrdiff_t n = source_->Read(buffer_.data() + end_, buffer_.size() - end_, &why);
    if (n < 0) {
      ++line_;
      Fail("cannot be read: " + why, StatusCode::kIoError);
      return false;
    }
    source_ended_ = n == 0;
    end_ += static_cast<std::size_t>(n);
  }
}

bool CsvReader::NextRow() {
  fields_.clear();
  do {
    if (!NextLine()) return false;
    text_ = Trimmed(text_);
  } while (text_.empty() || text_[0] == '#');
  row_ = text_;
  const std::string_view separators = separator_ == ' ' ? " \t" : ",";
  while (true) {
    const std::size_t end = text_.find_first_of(separators);
    fields_.push_back(Trimmed(text_.substr(0, end)));
    if (end == std::string_view::npos) return true;
    text_.remove_prefix(end + 1);
    // Any number of blanks separates.
    if (separator_ == ' ') text_ = Trimmed(text_);
  }
}

void CsvReader::ExpectFields(int n, std::string_view what) {
  if (ok() && num_fields() != n) {
    Fail("expected " + std::string(what) + ": " + std::to_string(n) + " fields, found " +
         std::to_string(num_fields()));
  }
}

double CsvReader::Number(int field, std::string_view what) {
  if (!ok()) return 0.0;
  double x = 0.0;
  if (field < num_fields()) {
    const std::string_view word = WithoutPlus(fields_[static_cast<std::size_t>(field)]);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    const bool whole = end == word.data() + word.size();
    if (error == std::errc() && whole && (std::isfinite(x) || non_finite_)) return x;
    if (error == std::errc::result_out_of_range && whole && non_finite_) {
      return std::numeric_limits<double>::infinity();
    }
  }
  FailExpected(field, what, "a finite number");
  return 0.0;
}

void CsvReader::Numbers(int first, int n, double* to, std::string_view what) {
  for (int i = 0; i < n; ++i)
    to[i] = Number(first + i, what);
}

std::int64_t CsvReader::Integer(int field, std::int64_t low, std::int64_t high,
                                std::string_view what) {
  if (!ok()) return 0;
  std::int64_t x = 0;
  if (field < num_fields()) {
    const std::string_view word = WithoutPlus(fields_[static_cast<std::size_t>(field)]);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    if (error == std::errc() && end == word.data() + word.size() && x >= low && x <= high) return x;
  }
  FailExpected(field, what,
               "an integer from " + std::to_string(low) + " to " + std::to_string(high));
  return 0;
}

}  // namespace glissade::internal
