// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/quick_number.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include "glissade/sim/noise_source.h"

namespace glissade::internal {
namespace {

/// What std::from_chars makes of a whole word.
template <class T>
bool Standard(std::string_view word, T* x) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), *x);
  return error == std::errc() && end == word.data() + word.size();
}

/// True where the quick one takes the word; then it must be the same bits.
bool SameDouble(const std::string& word) {
  const char* const end = word.data() + word.size();
  double quick = 0.0, standard = 0.0;
  if (QuickDouble(word.data(), end, &quick) != end) return false;
  EXPECT_TRUE(Standard(word, &standard)) << word;
  EXPECT_EQ(std::memcmp(&quick, &standard, sizeof(quick)), 0) << word;
  return true;
}

TEST(QuickNumber, DoublesHaveTheBitsOfTheStandardLibrary) {
  sim::NoiseSource random(1);
  char text[64];
  int taken = 0, words = 0;
  for (int k = 0; k < 200000; ++k) {
    const double magnitude = std::exp(random.Uniform(-60.0, 60.0));
    const double x = (random.Next() & 1) != 0 ? magnitude : -magnitude;
    const int digits = 1 + static_cast<int>(random.Next() % 18);
    for (const char* format : {"%.*g", "%.*e", "%+.*e", "%.*f"}) {
      std::snprintf(text, sizeof(text), format, digits, x);
      taken += SameDouble(text) ? 1 : 0;
      ++words;
    }
  }
  EXPECT_GT(taken, words / 4);
  // What files are full of.
  for (int k = 0; k < 100000; ++k) {
    std::snprintf(text, sizeof(text), "%.6e", random.Uniform(-600.0, 600.0));
    EXPECT_TRUE(SameDouble(text)) << text;
    std::snprintf(text, sizeof(text), "%.15g", random.Uniform(-600.0, 600.0));
    EXPECT_TRUE(SameDouble(text)) << text;
  }
}

TEST(QuickNumber, FormsOfNumbers) {
  for (const char* word : {"0", "-0", "+0", "7", "5.", ".5", "-.5e3", "1.e5", "1e22", "1E-22",
                           "1e+05", "9007199254740992", "0.000000000000001", "00012.50"}) {
    EXPECT_TRUE(SameDouble(word)) << word;
  }
  // Left to the standard library, which takes them or does not.
  for (const char* word : {"", "+", "-", ".", "e5", "1e", "1e+", "--1", "+-1", "nan", "inf", "1e23",
                           "1e-23", "9007199254740993", "1234567890123456789",
                           "12345678901234567890123", "1e99999999999999999999"}) {
    double x = 0.0;
    EXPECT_EQ(QuickDouble(word, word + std::strlen(word), &x), nullptr) << word;
  }
  // Whether a word ends where the number does is for the caller to see.
  double x = 0.0;
  for (const auto& [word, length] : {std::pair{"1.5x", 3}, {"0x10", 1}, {"1,5", 1}, {"7 8", 1}})
    EXPECT_EQ(QuickDouble(word, word + std::strlen(word), &x), word + length);
}

TEST(QuickNumber, Integers) {
  sim::NoiseSource random(2);
  for (int k = 0; k < 100000; ++k) {
    const auto wanted = static_cast<std::int64_t>(random.Next() >> (5 + random.Next() % 58));
    const std::string word = std::to_string((k & 1) != 0 ? -wanted : wanted);
    std::int64_t x = 0;
    const char* const end = word.data() + word.size();
    if (word.size() > 18) continue;
    ASSERT_EQ(QuickInteger(word.data(), end, &x), end) << word;
    EXPECT_EQ(x, (k & 1) != 0 ? -wanted : wanted);
  }
  for (const char* word :
       {"", "-", "+", "x", "1234567890123456789", "99999999999999999999999999"}) {
    std::int64_t x = 0;
    EXPECT_EQ(QuickInteger(word, word + std::strlen(word), &x), nullptr) << word;
  }
}

}  // namespace
}  // namespace glissade::internal
