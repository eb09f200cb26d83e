// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/decimal_seconds.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <system_error>

namespace glissade::internal {

namespace {

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

/// The number after the "e"; false where there is none. Beyond +-10^6 all are alike.
bool ParseExponent(std::string_view text, std::int64_t* exponent) {
  if (text.size() > 1 && text[0] == '+' && IsDigit(text[1])) text.remove_prefix(1);
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument) return false;
  constexpr int kMost = 1000000;
  *exponent =
      error == std::errc() ? std::clamp(value, -kMost, kMost) : (text[0] == '-' ? -kMost : kMost);
  return true;
}

}  // namespace

std::optional<std::int64_t> NanosecondsOf(std::string_view text) {
  const bool negative = !text.empty() && text[0] == '-';
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  // Digits without the point, and where the point was.
  std::string digits;
  std::size_t k = 0, before_point = 0;
  bool point = false;
  for (; k < text.size() && (IsDigit(text[k]) || (text[k] == '.' && !point)); ++k) {
    if (text[k] == '.') {
      point = true;
    } else {
      digits += text[k];
      if (!point) ++before_point;
    }
  }
  if (digits.empty()) return std::nullopt;
  std::int64_t exponent = 0;
  if (k < text.size()) {
    if (text[k] != 'e' && text[k] != 'E') return std::nullopt;
    if (!ParseExponent(text.substr(k + 1), &exponent)) return std::nullopt;
  }
  // The number of digits that are whole nanoseconds.
  const std::int64_t whole = static_cast<std::int64_t>(before_point) + exponent + 9;
  constexpr std::uint64_t kMax = std::numeric_limits<std::int64_t>::max();
  const std::uint64_t most = kMax + (negative ? 1 : 0);
  std::uint64_t value = 0;
  for (std::int64_t i = 0; i < whole; ++i) {
    const bool there = static_cast<std::size_t>(i) < digits.size();
    if (!there && value == 0) break;  // zeros only
    const auto digit =
        there ? static_cast<std::uint64_t>(digits[static_cast<std::size_t>(i)] - '0') : 0;
    if (value > (most - digit) / 10) return std::nullopt;
    value = 10 * value + digit;
  }
  const bool up = whole >= 0 && static_cast<std::size_t>(whole) < digits.size() &&
                  digits[static_cast<std::size_t>(whole)] >= '5';
  if (up) {
    if (value == most) return std::nullopt;
    ++value;
  }
  return static_cast<std::int64_t>(negative ? std::uint64_t{0} - value : value);
}

std::string SecondsOf(std::int64_t nanoseconds) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  const auto bits = static_cast<std::uint64_t>(nanoseconds);
  const std::uint64_t value = nanoseconds < 0 ? std::uint64_t{0} - bits : bits;
  const std::string fraction = std::to_string(value % kSecond);
  std::string text = nanoseconds < 0 ? "-" : "";
  text.append(std::to_string(value / kSecond)).append(1, '.');
  return text.append(9 - fraction.size(), '0').append(fraction);
}

}  // namespace glissade::internal
