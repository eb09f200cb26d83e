// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// \file
/// Random numbers that are the same bits on every machine. The C++ standard fixes its engines but
/// not its distributions, and the last bit of log() depends on the C library and on the processor.
/// Here both are written out, in operations that IEEE 754 rounds in one way only. The draws follow
/// libstdc++, whose numbers the course's published run came from.
namespace glissade::sim {

/// The minimal standard generator of Park and Miller with multiplier 16807, as std::minstd_rand0:
/// libstdc++'s default_random_engine.
class MinstdRand0 {
 public:
  static constexpr std::uint32_t kMin = 1;
  static constexpr std::uint32_t kMax = 2147483646;

  /// A seed that is 0 modulo 2^31 - 1 counts as 1.
  explicit MinstdRand0(std::uint32_t seed = 1);
  /// The next number, kMin to kMax.
  std::uint32_t Next();
  /// The next two numbers as one double in [0, 1): 53 random bits.
  double NextCanonical();

 private:
  std::uint32_t state_;
};

/// A number in [low, high), from two of the engine's.
double UniformReal(MinstdRand0& engine, double low, double high);

/// Normal distribution by the polar method (Marsaglia), which makes two numbers at a time: the
/// second is kept for the next call, so how many objects share an engine matters.
class NormalReal {
 public:
  explicit NormalReal(double mean = 0.0, double sigma = 1.0) : mean_(mean), sigma_(sigma) {}
  double operator()(MinstdRand0& engine);

 private:
  double mean_;
  double sigma_;
  double saved_ = 0.0;
  bool has_saved_ = false;
};

/// Natural logarithm of a finite x > 0, correctly rounded but for one x in about 1e13: computed in
/// pairs of doubles.
double CorrectlyRoundedLog(double x);

}  // namespace glissade::sim
