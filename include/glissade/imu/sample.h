// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/base/matrix.h"

namespace glissade {

/// One reading of gyroscope and accelerometer, in body axes.
struct ImuSample {
  std::int64_t stamp_ns = 0;
  Vector3 gyro = Vector3::Zero();   ///< rad/s
  Vector3 accel = Vector3::Zero();  ///< specific force, m/s^2; at rest -R_W_B' g
  /// The sensor was at the end of its range: ImuBuffer sets these, preintegration trusts such a
  /// sample less.
  bool gyro_saturated = false;
  bool accel_saturated = false;
};

/// Seconds from `from` to `to`, where to >= from; no pair of stamps overflows.
inline double SecondsBetween(std::int64_t from, std::int64_t to) {
  return 1e-9 *
         static_cast<double>(static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from));
}

/// What the sensor would have read at `stamp_ns`, linearly between two samples: a.stamp_ns <=
/// stamp_ns <= b.stamp_ns, not all equal. Saturated where one of the two was and has a part in it.
inline ImuSample Interpolate(const ImuSample& a, const ImuSample& b, std::int64_t stamp_ns) {
  if (stamp_ns == a.stamp_ns) return a;
  if (stamp_ns == b.stamp_ns) return b;
  const double t = SecondsBetween(a.stamp_ns, stamp_ns) / SecondsBetween(a.stamp_ns, b.stamp_ns);
  ImuSample x;
  x.stamp_ns = stamp_ns;
  x.gyro = (1.0 - t) * a.gyro + t * b.gyro;
  x.accel = (1.0 - t) * a.accel + t * b.accel;
  x.gyro_saturated = a.gyro_saturated || b.gyro_saturated;
  x.accel_saturated = a.accel_saturated || b.accel_saturated;
  return x;
}

}  // namespace glissade
