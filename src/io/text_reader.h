// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "glissade/base/status.h"
#include "io/byte_source.h"

namespace glissade::internal {

/// Reads a text file, plain or compressed, word by word (separated by white space), and knows the
/// line of each. The file is streamed: memory does not grow with it.
///
/// The first thing that goes wrong is kept as status() = "path:line: what"; from then on every call
/// does nothing and returns 0 or an empty word. So a format reads straight down, and asks ok() at
/// the end and in every loop whose length the file itself has said.
///
/// `what` names the thing read, for the message; where index >= 0 it is appended: "camera of
/// observation" 17.
class TextReader {
 public:
  /// From `comment` to the end of the line is skipped where a word would begin; 0: no comments.
  static Result<TextReader> Open(const std::string& path, char comment = '\0');
  /// Reads from a file that has been opened.
  TextReader(std::string path, char comment, std::unique_ptr<ByteSource> source);

  [[nodiscard]] bool ok() const { return status_.ok(); }
  [[nodiscard]] const Status& status() const { return status_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Bytes of the file, 0 where they are not known (compressed, a pipe).
  [[nodiscard]] std::int64_t size() const { return source_->Size(); }
  /// Line of the word read last, from 1.
  [[nodiscard]] std::int64_t line() const { return word_line_; }

  /// Fails at the line of the word read last; the first failure is kept.
  void Fail(StatusCode code, const std::string& message);
  void Fail(const std::string& message) { Fail(StatusCode::kParseError, message); }

  /// True where only white space and comments are left, and after a failure.
  bool AtEnd();
  /// The next word without taking it; empty at the end. Valid until the next call.
  std::string_view Peek();
  /// The next word; fails at the end of the file. Valid until the next call.
  std::string_view Word(std::string_view what, std::int64_t index = -1);
  /// Fails unless the next word is this one.
  void Expect(std::string_view word);
  /// Fails unless the file ends here.
  void ExpectEnd();
  /// True where nothing but white space and comments follows on the line of the word read last.
  bool AtEndOfLine();

  /// A finite number.
  double Number(std::string_view what, std::int64_t index = -1);
  /// A finite number > 0.
  double Positive(std::string_view what, std::int64_t index = -1);
  void Numbers(double* to, int n, std::string_view what, std::int64_t index = -1);
  /// An integer, low <= x <= high.
  std::int64_t Integer(std::int64_t low, std::int64_t high, std::string_view what,
                       std::int64_t index = -1);
  /// How many of something follow: low <= x < 2^31.
  int Count(int low, std::string_view what);
  /// An index, 0 <= x < size.
  int Index(int size, std::string_view what, std::int64_t index = -1);

 private:
  friend class Result<TextReader>;
  TextReader() = default;

  bool NextWord();
  /// The next word by `read`, QuickDouble or QuickInteger; false, and nothing read, where it is not
  /// what they know or the buffer ends too soon.
  template <class T>
  bool QuickWord(const char* (*read)(const char*, const char*, T*), T* x);
  bool Refill();
  /// "expected WHAT INDEX, found ..." of the present word.
  void FailExpected(std::string_view what, std::int64_t index, std::string_view rule);

  std::string path_;
  char comment_ = '\0';
  std::unique_ptr<ByteSource> source_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // not yet looked at: [begin_, end_)
  std::size_t end_ = 0;
  bool source_ended_ = false;
  bool peeked_ = false;
  std::string_view word_;
  std::int64_t line_ = 1;
  std::int64_t word_line_ = 1;
  Status status_;
};

/// A word fit for a one-line message: shortened, control characters replaced.
std::string Printable(std::string_view word);

/// How much to reserve for a count that a file claims: a lie must not cost gigabytes. `most` is how
/// many the file can hold, where that is known.
inline std::size_t ReserveFor(std::int64_t count, std::int64_t most = 0) {
  constexpr std::int64_t kMost = 1 << 20;
  if (most < kMost) most = kMost;
  return static_cast<std::size_t>(count < most ? count : most);
}

}  // namespace glissade::internal
