// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/json_value.h"

#include <charconv>
#include <cmath>
#include <system_error>

#include "io/byte_source.h"
#include "io/text_reader.h"

namespace glissade::internal {

namespace {

constexpr int kMostLevels = 64;
constexpr std::size_t kMostBytes = std::size_t{1} << 18;

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

class Parser {
 public:
  Parser(const std::string& path, std::string_view text) : path_(path), text_(text) {}

  Result<JsonValue> Parse() {
    JsonValue value;
    if (!Value(&value, 0)) return status_;
    SkipSpace();
    if (at_ < text_.size()) {
      Fail("the end of the file");
      return status_;
    }
    return value;
  }

 private:
  bool Fail(std::string_view expected) {
    if (status_.ok()) {
      const std::string found = at_ < text_.size() ? "'" + Printable(text_.substr(at_, 16)) + "'"
                                                   : std::string("the end of the file");
      status_ =
          Status(StatusCode::kParseError, path_ + ":" + std::to_string(line_) + ": expected " +
                                              std::string(expected) + ", found " + found);
    }
    return false;
  }

  void SkipSpace() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') ++line_;
      if (c != ' ' && c != '\t' && c != '\n' && c != '\r') break;
    }
  }

  [[nodiscard]] char Next() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  bool Take(char c) {
    SkipSpace();
    if (Next() != c || at_ >= text_.size()) return false;
    ++at_;
    return true;
  }

  bool Literal(std::string_view word) {
    if (text_.substr(at_, word.size()) != word) return Fail("a value");
    at_ += word.size();
    return true;
  }

  bool Value(JsonValue* value, int level) {
    SkipSpace();
    value->line = line_;
    if (level > kMostLevels) return Fail("fewer than 64 levels");
    switch (Next()) {
      case '{':
        value->kind = JsonValue::Kind::kObject;
        return Object(value, level);
      case '[':
        value->kind = JsonValue::Kind::kArray;
        return Array(value, level);
      case '"':
        value->kind = JsonValue::Kind::kString;
        return String(&value->string);
      case 't':
      case 'f':
        value->kind = JsonValue::Kind::kBool;
        value->boolean = Next() == 't';
        return Literal(value->boolean ? "true" : "false");
      case 'n':
        return Literal("null");
      default:
        value->kind = JsonValue::Kind::kNumber;
        return Number(&value->number);
    }
  }

  bool Object(JsonValue* value, int level) {
    ++at_;
    if (Take('}')) return true;
    do {
      SkipSpace();
      std::string name;
      if (Next() != '"') return Fail("a name in quotes");
      if (!String(&name)) return false;
      if (value->Find(name) != nullptr) return Fail("'" + Printable(name) + "' only once");
      if (!Take(':')) return Fail("':'");
      JsonValue member;
      if (!Value(&member, level + 1)) return false;
      value->members.emplace_back(std::move(name), std::move(member));
    } while (Take(','));
    return Take('}') || Fail("',' or '}'");
  }

  bool Array(JsonValue* value, int level) {
    ++at_;
    if (Take(']')) return true;
    do {
      if (!Value(&value->items.emplace_back(), level + 1)) return false;
    } while (Take(','));
    return Take(']') || Fail("',' or ']'");
  }

  bool String(std::string* to) {
    for (++at_; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '"') {
        ++at_;
        return true;
      }
      if (static_cast<unsigned char>(c) < 0x20) return Fail("the end of a string");
      if (c != '\\') {
        *to += c;
        continue;
      }
      if (++at_ >= text_.size()) break;
      if (!Escape(to)) return false;
    }
    return Fail("the end of a string");
  }

  /// at_ is behind the backslash, and is left at the last character of the escape.
  bool Escape(std::string* to) {
    constexpr std::string_view kNames = "\"\\/bfnrt";
    constexpr std::string_view kMeans = "\"\\/\b\f\n\r\t";
    const std::size_t which = kNames.find(text_[at_]);
    if (which != std::string_view::npos) {
      *to += kMeans[which];
      return true;
    }
    unsigned code = 0;
    const std::string_view digits = text_.substr(at_ + 1, 4);
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
    if (text_[at_] != 'u' || error != std::errc() || end - digits.data() != 4) {
      return Fail("an escape sequence");
    }
    at_ += 4;
    // As UTF-8; halves of surrogate pairs are of no use to us.
    if (code >= 0xd800 && code < 0xe000) code = '?';
    const auto put = [&](unsigned byte) { *to += static_cast<char>(byte); };
    if (code < 0x80) {
      put(code);
    } else if (code < 0x800) {
      put(0xc0u | code >> 6);
      put(0x80u | (code & 0x3fu));
    } else {
      put(0xe0u | code >> 12);
      put(0x80u | (code >> 6 & 0x3fu));
      put(0x80u | (code & 0x3fu));
    }
    return true;
  }

  bool Number(double* to) {
    const std::string_view rest = text_.substr(at_);
    const bool signed_ = !rest.empty() && rest[0] == '-';
    // from_chars knows "inf" and "nan"; JSON does not.
    if (rest.size() <= (signed_ ? 1u : 0u) || !IsDigit(rest[signed_ ? 1 : 0])) {
      return Fail("a value");
    }
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), *to);
    if (error != std::errc() || !std::isfinite(*to)) return Fail("a number that a double can hold");
    at_ += static_cast<std::size_t>(end - rest.data());
    return true;
  }

  const std::string& path_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::int64_t line_ = 1;
  Status status_;
};

}  // namespace

const JsonValue* JsonValue::Find(std::string_view name) const {
  for (const auto& [key, value] : members) {
    if (key == name) return &value;
  }
  return nullptr;
}

std::string_view ToString(JsonValue::Kind kind) {
  switch (kind) {
    case JsonValue::Kind::kNull:
      return "null";
    case JsonValue::Kind::kBool:
      return "true or false";
    case JsonValue::Kind::kNumber:
      return "number";
    case JsonValue::Kind::kString:
      return "string";
    case JsonValue::Kind::kArray:
      return "array";
    case JsonValue::Kind::kObject:
      return "object";
  }
  return "value";
}

Result<JsonValue> ReadJson(const std::string& path) {
  auto source = OpenByteSource(path);
  if (!source.ok()) return source.status();
  std::string text;
  std::string why;
  char buffer[4096];
  while (true) {
    const std::ptrdiff_t n = (*source)->Read(buffer, sizeof(buffer), &why);
    if (n < 0) return Status(StatusCode::kIoError, path + ": cannot be read: " + why);
    if (n == 0) break;
    text.append(buffer, static_cast<std::size_t>(n));
    if (text.size() > kMostBytes)
      return Status(StatusCode::kParseError, path + ": over 256 kB: no calibration");
  }
  return Parser(path, text).Parse();
}

}  // namespace glissade::internal
