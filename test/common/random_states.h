// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "glissade/lie/pose.h"
#include "glissade/lie/so3.h"

namespace glissade::test {

/// Seeded random states, the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// In [low, high).
  double Uniform(double low, double high) {
    state_ += 0x9e3779b97f4a7c15u;  // splitmix64
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    const double unit = static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    return low + (high - low) * unit;
  }

  Vector2 Vec2(double size) { return {Uniform(-size, size), Uniform(-size, size)}; }
  Vector3 Vec3(double size) {
    return {Uniform(-size, size), Uniform(-size, size), Uniform(-size, size)};
  }

  Vector3 Direction() {
    Vector3 v;
    do {
      v = Vec3(1.0);
    } while (v.squaredNorm() > 1.0 || v.squaredNorm() < 1e-2);
    return v.normalized();
  }

  /// Rotation by `angle` about a random axis.
  Quaternion Rotation(double angle) { return so3::ExpQuaternion(angle * Direction()); }
  /// Rotation by an angle in [0, pi).
  Quaternion Rotation() { return Rotation(Uniform(0.0, std::numbers::pi)); }

  Pose RandomPose(double size) {
    const Quaternion q = Rotation();
    return {q, Vec3(size)};
  }
  Pose RandomPose(double size, double angle) {
    const Quaternion q = Rotation(angle);
    return {q, Vec3(size)};
  }

 private:
  std::uint64_t state_;
};

/// Rotation angles at which something special happens in some formula, or close to it.
inline constexpr double kSpecialAngles[] = {0.0,
                                            1e-12,
                                            1e-9,
                                            1e-6,
                                            1e-4,
                                            1e-3,
                                            0.499,
                                            0.501,
                                            1.0,
                                            std::numbers::pi / 2,
                                            std::numbers::pi - 1e-1,
                                            std::numbers::pi - 1e-3,
                                            std::numbers::pi - 1e-5};

}  // namespace glissade::test
