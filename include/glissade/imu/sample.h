// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "glissade/base/matrix.h"

namespace glissade {

/// Two readings further apart than this are a gap, unless options say otherwise: ten samples lost
/// at 200 Hz.
inline constexpr std::int64_t kMaxImuGapNs = 50'000'000;

/// One reading of gyroscope and accelerometer, in body axes.
struct ImuSample {
  std::int64_t stamp_ns = 0;
  Vector3 gyro = Vector3::Zero();   ///< rad/s
  Vector3 accel = Vector3::Zero();  ///< specific force, m/s^2; at rest -R_W_B' g
  /// The sensor was at the end of its range: ImuBuffer sets these, preintegration trusts such a
  /// sample less.
  bool gyro_saturated = false;
  bool accel_saturated = false;
  /// 0: a reading. Else no reading, but interpolated between two that are this far apart (set by
  /// Interpolate); preintegration asks whether that was a gap.
  std::int64_t interpolated_over_ns = 0;
};

/// Seconds from `from` to `to`, where to >= from; no pair of stamps overflows.
inline double SecondsBetween(std::int64_t from, std::int64_t to) {
  return 1e-9 *
         static_cast<double>(static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from));
}

/// From `from` to `to`, where to >= from; the largest number where that does not fit.
inline std::int64_t NanosecondsBetween(std::int64_t from, std::int64_t to) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  const std::uint64_t ns = static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  return ns > static_cast<std::uint64_t>(kMost) ? kMost : static_cast<std::int64_t>(ns);
}

/// What the sensor would have read at `stamp_ns`, linearly between two samples: a.stamp_ns <=
/// stamp_ns <= b.stamp_ns, not all equal. Saturated where one of the two was and has a part in it.
template <int = 0>
ImuSample Interpolate(const ImuSample& a, const ImuSample& b, std::int64_t stamp_ns) {
  if (stamp_ns == a.stamp_ns) return a;
  if (stamp_ns == b.stamp_ns) return b;
  const double t = SecondsBetween(a.stamp_ns, stamp_ns) / SecondsBetween(a.stamp_ns, b.stamp_ns);
  ImuSample x;
  x.stamp_ns = stamp_ns;
  x.gyro = (1.0 - t) * a.gyro + t * b.gyro;
  x.accel = (1.0 - t) * a.accel + t * b.accel;
  x.gyro_saturated = a.gyro_saturated || b.gyro_saturated;
  x.accel_saturated = a.accel_saturated || b.accel_saturated;
  x.interpolated_over_ns = std::max(
      {NanosecondsBetween(a.stamp_ns, b.stamp_ns), a.interpolated_over_ns, b.interpolated_over_ns});
  return x;
}

}  // namespace glissade
