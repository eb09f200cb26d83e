// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// \file
/// The numbers that nearly all of a file consists of, read in one pass over their characters. What
/// is of another form is left to std::from_chars, and what is no number to its reader's complaint.
namespace glissade::internal {

/// The integer that begins at `begin`, with at most 18 digits and perhaps a sign, in *x. Returns
/// its end, null where there is none of this form. Whether a word ends there is for the caller to
/// see.
inline const char* QuickInteger(const char* begin, const char* end, std::int64_t* x) {
  const char* p = begin;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  const char* const digits = p;
  std::uint64_t value = 0;  // wraps around where there are too many
  while (p != end && *p >= '0' && *p <= '9')
    value = 10 * value + static_cast<std::uint64_t>(*p++ - '0');
  if (p == digits || p - digits > 18) return nullptr;
  *x = negative ? -static_cast<std::int64_t>(value) : static_cast<std::int64_t>(value);
  return p;
}

/// The same for a decimal number of at most 18 digits that is m 10^k with whole m <= 2^53 and
/// |k| <= 22. Both are doubles exactly, so that one multiplication or division, which IEEE 754
/// rounds correctly, gives the double nearest to it (W. Clinger, How to read floating point numbers
/// accurately, PLDI 1990).
inline const char* QuickDouble(const char* begin, const char* end, double* x) {
  static constexpr double kPowers[23] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                         1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                         1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const char* p = begin;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  std::uint64_t mantissa = 0;
  const char* const digits = p;
  while (p != end && *p >= '0' && *p <= '9')
    mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
  std::int64_t count = p - digits;
  std::int64_t exponent = 0;
  if (p != end && *p == '.') {
    const char* const fraction = ++p;
    while (p != end && *p >= '0' && *p <= '9')
      mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
    exponent = fraction - p;
    count += p - fraction;
  }
  if (count == 0 || count > 18 || mantissa > (std::uint64_t{1} << 53)) return nullptr;
  if (p != end && (*p == 'e' || *p == 'E')) {
    std::int64_t written = 0;
    p = QuickInteger(p + 1, end, &written);
    if (p == nullptr) return nullptr;
    exponent += written;
  }
  if (exponent < -22 || exponent > 22) return nullptr;
  const auto value = static_cast<double>(mantissa);
  const double magnitude = exponent < 0 ? value / kPowers[-exponent] : value * kPowers[exponent];
  *x = negative ? -magnitude : magnitude;
  return p;
}

}  // namespace glissade::internal
