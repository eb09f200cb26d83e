// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace glissade::sim {
namespace {

TEST(Random, EngineIsTheStandardOne) {
  MinstdRand0 ours;
  std::uint32_t last = 0;
  for (int k = 0; k < 10000; ++k)
    last = ours.Next();
  EXPECT_EQ(last, 1043618065u);  // [rand.predef] of the C++ standard

  for (std::uint32_t seed : {0u, 1u, 7u, 2147483646u, 2147483647u, 4294967295u}) {
    MinstdRand0 engine(seed);
    std::minstd_rand0 standard(seed);
    for (int k = 0; k < 1000; ++k)
      ASSERT_EQ(engine.Next(), standard()) << seed;
  }
}

TEST(Random, CanonicalStaysBelowOne) {
  // All of a period cannot be tried; the largest pair can.
  const double range = 2147483646.0;
  const double most = (range - 1.0) + (range - 1.0) * range;
  EXPECT_LE(most / (range * range), 1.0);
  MinstdRand0 engine;
  for (int k = 0; k < 100000; ++k) {
    const double x = engine.NextCanonical();
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
  }
}

// libstdc++ drew the published numbers. Its generate_canonical is another one from GCC 15 on.
#if defined(_GLIBCXX_RELEASE) && _GLIBCXX_RELEASE < 15
TEST(Random, UniformIsLibstdcxxsToTheBit) {
  MinstdRand0 ours;
  std::minstd_rand0 standard;
  for (int k = 0; k < 100000; ++k) {
    std::uniform_real_distribution<double> distribution(-4.0, 7.5);
    ASSERT_EQ(UniformReal(ours, -4.0, 7.5), distribution(standard)) << k;
  }
}

TEST(Random, NormalIsLibstdcxxsUpToTheLastBitOfLog) {
  MinstdRand0 ours;
  std::minstd_rand0 standard;
  NormalReal normal(0.5, 1e-3);
  std::normal_distribution<double> distribution(0.5, 1e-3);
  int different = 0;
  for (int k = 0; k < 100000; ++k) {
    const double x = normal(ours);
    const double y = distribution(standard);
    ASSERT_NEAR(x, y, 2e-16) << k;
    different += x != y;
  }
  EXPECT_LT(different, 1000);
}
#endif

TEST(Random, NormalHasItsMoments) {
  MinstdRand0 engine(5);
  NormalReal normal(2.0, 3.0);
  constexpr int kDraws = 200000;
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (int k = 0; k < kDraws; ++k) {
    const double x = (normal(engine) - 2.0) / 3.0;
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.01);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.01);
  EXPECT_NEAR(fourth / kDraws, 3.0, 0.1);
}

TEST(Random, LogIsCorrectlyRounded) {
  EXPECT_EQ(CorrectlyRoundedLog(1.0), 0.0);
  // Hard ones: extended precision, rounded again, errs by one unit in the last place. Values from
  // 60-digit decimal arithmetic.
  const double hard[][2] = {
      {0x1.d1acabc8p-3, -0x1.7b2b7933dd6dfp+0}, {0x1.09abd604p-2, -0x1.5965f8e1fe267p+0},
      {0x1.dc19909cp-2, -0x1.881cba60c5653p-1}, {0x1.7848009ap-1, -0x1.3b6122ca5a48dp-2},
      {0x1.005858c8p-1, -0x1.62339cd5c9fe3p-1}, {0x1.48d48986p-1, -0x1.c568eb30ff59bp-2},
      {0x1.d191e4bp-4, -0x1.1656250eae6adp+1},  {0x1.84283e6cp-2, -0x1.f0abe2d8833bbp-1},
  };
  for (const auto& [x, log_x] : hard)
    EXPECT_EQ(CorrectlyRoundedLog(x), log_x) << x;

  MinstdRand0 engine;
  for (int k = 0; k < 100000; ++k) {
    const double x = std::ldexp(engine.NextCanonical(), k % 200 - 100);
    if (x == 0.0) continue;
    const double log_x = std::log(x);
    ASSERT_NEAR(CorrectlyRoundedLog(x), log_x, 3e-16 * std::abs(log_x)) << x;
  }
}

}  // namespace
}  // namespace glissade::sim
