// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/text_reader.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include "io/quick_number.h"

namespace glissade::internal {

namespace {

// Longer words are no numbers and no keywords: what has them is not a text file.
constexpr std::size_t kBufferSize = std::size_t{1} << 17;

bool IsSpace(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/// from_chars knows no leading '+', which printf("%+e") writes.
std::string_view WithoutPlus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  return word;
}

std::string Named(std::string_view what, std::int64_t index) {
  std::string name(what);
  if (index >= 0) name += " " + std::to_string(index);
  return name;
}

}  // namespace

std::string Printable(std::string_view word) {
  constexpr std::size_t kMost = 32;
  std::string text(word.substr(0, kMost));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  if (word.size() > kMost) text += "...";
  return text;
}

Result<TextReader> TextReader::Open(const std::string& path, char comment) {
  auto source = OpenByteSource(path);
  if (!source.ok()) return source.status();
  return TextReader(path, comment, std::move(source).value());
}

TextReader::TextReader(std::string path, char comment, std::unique_ptr<ByteSource> source)
    : path_(std::move(path)), comment_(comment), source_(std::move(source)), buffer_(kBufferSize) {}

void TextReader::Fail(StatusCode code, const std::string& message) {
  if (!status_.ok()) return;
  status_ = Status(code, path_ + ":" + std::to_string(word_line_) + ": " + message);
  word_ = {};
}

void TextReader::FailExpected(std::string_view what, std::int64_t index, std::string_view rule) {
  std::string message = "expected " + Named(what, index);
  if (!rule.empty()) message += " (" + std::string(rule) + ")";
  message += word_.empty() ? ", found the end of the file" : ", found '" + Printable(word_) + "'";
  Fail(message);
}

/// Keeps [begin_, end_) and appends what the file has next; false at its end and on failure.
bool TextReader::Refill() {
  if (source_ended_) return false;
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (end_ == buffer_.size()) {
    word_line_ = line_;
    Fail("a word of over " + std::to_string(kBufferSize) + " characters: not a text file");
    return false;
  }
  std::string why;
  const std::ptrdiff_t n = source_->Read(buffer_.data() + end_, buffer_.size() - end_, &why);
  if (n < 0) {
    word_line_ = line_;
    Fail(StatusCode::kIoError, "cannot be read: " + why);
  }
  if (n <= 0) {
    source_ended_ = true;
    return false;
  }
  end_ += static_cast<std::size_t>(n);
  return true;
}

/// Finds the next word; false, and word_ empty, at the end of the file and after a failure.
bool TextReader::NextWord() {
  if (!ok()) return false;
  if (peeked_) {
    peeked_ = false;
    return !word_.empty();
  }
  word_ = {};
  bool in_comment = false;
  while (true) {
    while (begin_ < end_ && (in_comment || IsSpace(buffer_[begin_]))) {
      if (buffer_[begin_] == '\n') {
        ++line_;
        in_comment = false;
      }
      ++begin_;
    }
    if (begin_ == end_) {
      if (Refill()) continue;
      word_line_ = line_;
      return false;
    }
    if (comment_ == '\0' || buffer_[begin_] != comment_) break;
    in_comment = true;
  }
  std::size_t length = 1;
  while (true) {
    while (begin_ + length < end_ && !IsSpace(buffer_[begin_ + length]))
      ++length;
    if (begin_ + length < end_ || !Refill()) break;
  }
  if (!ok()) return false;
  word_ = std::string_view(buffer_.data() + begin_, length);
  begin_ += length;
  word_line_ = line_;
  return true;
}

template <class T>
bool TextReader::QuickWord(const char* (*read)(const char*, const char*, T*), T* x) {
  if (peeked_ || !ok()) return false;
  const char* p = buffer_.data() + begin_;
  const char* const end = buffer_.data() + end_;
  while (p != end && IsSpace(*p))
    line_ += *p++ == '\n' ? 1 : 0;
  begin_ = static_cast<std::size_t>(p - buffer_.data());
  const char* const after = read(p, end, x);
  if (after == nullptr || after == end || !IsSpace(*after)) return false;
  word_ = std::string_view(p, static_cast<std::size_t>(after - p));
  begin_ += word_.size();
  word_line_ = line_;
  return true;
}

std::string_view TextReader::Peek() {
  if (!peeked_) {
    NextWord();
    peeked_ = true;
  }
  return word_;
}

bool TextReader::AtEnd() {
  return Peek().empty();
}

std::string_view TextReader::Word(std::string_view what, std::int64_t index) {
  if (!NextWord()) FailExpected(what, index, "");
  return word_;
}

void TextReader::Expect(std::string_view word) {
  if (!NextWord() || word_ != word) FailExpected(word, -1, "");
}

void TextReader::ExpectEnd() {
  if (NextWord()) FailExpected("the end of the file", -1, "");
}

bool TextReader::AtEndOfLine() {
  for (std::size_t k = begin_; !peeked_ && k < end_ && IsSpace(buffer_[k]); ++k) {
    if (buffer_[k] == '\n') return true;
  }
  const std::int64_t line = word_line_;
  return AtEnd() || word_line_ != line;
}

double TextReader::Number(std::string_view what, std::int64_t index) {
  if (double quick = 0.0; QuickWord<double>(QuickDouble, &quick)) return quick;
  if (!NextWord()) {
    FailExpected(what, index, "a number");
    return 0.0;
  }
  const std::string_view digits = WithoutPlus(word_);
  double x = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
  if (error == std::errc::result_out_of_range) {
    FailExpected(what, index, "a number that a double can hold");
    return 0.0;
  }
  if (error != std::errc() || end != digits.data() + digits.size()) {
    FailExpected(what, index, "a number");
    return 0.0;
  }
  if (!std::isfinite(x)) {
    FailExpected(what, index, "a finite number");
    return 0.0;
  }
  return x;
}

double TextReader::Positive(std::string_view what, std::int64_t index) {
  const double x = Number(what, index);
  if (ok() && !(x > 0.0)) FailExpected(what, index, "a number > 0");
  return x;
}

void TextReader::Numbers(double* to, int n, std::string_view what, std::int64_t index) {
  for (int i = 0; i < n; ++i)
    to[i] = Number(what, index);
}

std::int64_t TextReader::Integer(std::int64_t low, std::int64_t high, std::string_view what,
                                 std::int64_t index) {
  std::int64_t quick = 0;
  if (QuickWord<std::int64_t>(QuickInteger, &quick)) {
    if (quick >= low && quick <= high) return quick;
    peeked_ = true;  // the word is looked at once more, to say what is wrong with it
  }
  if (!NextWord()) {
    FailExpected(what, index, "an integer");
    return 0;
  }
  const std::string_view digits = WithoutPlus(word_);
  std::int64_t x = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
  const bool whole = end == digits.data() + digits.size();
  if (error == std::errc::invalid_argument || !whole) {
    FailExpected(what, index, "an integer");
    return 0;
  }
  if (error != std::errc() || x < low || x > high) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
    FailExpected(what, index,
                 high >= kMost ? "at least " + std::to_string(low)
                               : std::to_string(low) + " to " + std::to_string(high));
    return 0;
  }
  return x;
}

int TextReader::Count(int low, std::string_view what) {
  return static_cast<int>(Integer(low, std::numeric_limits<std::int32_t>::max(), what));
}

int TextReader::Index(int size, std::string_view what, std::int64_t index) {
  return static_cast<int>(Integer(0, size - 1, what, index));
}

}  // namespace glissade::internal
