// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/base/matrix.h"

namespace glissade::sim {

/// Random numbers for Monte-Carlo studies: xoshiro256++ (Blackman, Vigna 2021), whose streams for
/// neighbouring seeds have nothing in common (those of a congruential engine do). The same numbers
/// on every machine with the same log().
class NoiseSource {
 public:
  /// `stream` separates uses of one seed: what is drawn for pixels does not shift what is drawn for
  /// the IMU.
  explicit NoiseSource(std::uint64_t seed, std::uint64_t stream = 0);

  std::uint64_t Next();
  /// In [low, high).
  double Uniform(double low, double high);
  /// Normal, mean 0 (polar method).
  double Normal(double sigma);

  Vector3 Normal3(double sigma) {
    const double x = Normal(sigma), y = Normal(sigma);
    return {x, y, Normal(sigma)};
  }
  /// Each coordinate in [-size, size).
  Vector3 Uniform3(double size) {
    const double x = Uniform(-size, size), y = Uniform(-size, size);
    return {x, y, Uniform(-size, size)};
  }
  /// Of unit length, all directions alike.
  Vector3 Direction() {
    Vector3 v;
    do {
      v = Normal3(1.0);
    } while (!(v.squaredNorm() > 1e-12));
    return v.normalized();
  }

 private:
  std::uint64_t state_[4];
  double saved_ = 0.0;
  bool has_saved_ = false;
};

}  // namespace glissade::sim
