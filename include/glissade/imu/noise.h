// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/base/matrix.h"
#include "glissade/base/validate.h"
#include "glissade/imu/sample.h"

namespace glissade {

/// What preintegration does where readings are missing.
enum class ImuGaps : std::uint8_t {
  kInflate,  ///< interpolates, and says how little it knows (ImuNoise::gap_gyro_walk)
  kRefuse,   ///< fails
};

/// Noise of an IMU in continuous time, as data sheets and Kalibr give it. The noise of one sample
/// has sigma = density * sqrt(rate).
struct ImuNoise {
  double gyro_noise_density = 1.7e-4;   ///< rad/s/sqrt(Hz)
  double accel_noise_density = 2.0e-3;  ///< m/s^2/sqrt(Hz)
  double gyro_random_walk = 2.0e-5;     ///< of the bias, rad/s^2/sqrt(Hz)
  double accel_random_walk = 3.0e-3;    ///< of the bias, m/s^3/sqrt(Hz)
  /// A saturated sample has this many times the sigma: the sensor says "at least this much".
  double saturation_inflation = 100.0;

  /// No reading for longer than this is a gap. Some ten periods of the sensor.
  std::int64_t max_gap_ns = kMaxImuGapNs;
  ImuGaps gaps = ImuGaps::kInflate;
  /// What the body may do unobserved: in a gap, angular rate and specific force are taken as linear
  /// between the readings at its ends plus a random walk of this density that is 0 at both. A gap
  /// of T then has, beside the noise of the sensor, sigma walk * sqrt(T^3 / 12) in rotation and
  /// velocity and walk * sqrt(T^5 / 45) in position: 0.01 rad, 0.03 m/s, 0.7 mm in 0.05 s, and
  /// 0.3 rad, 0.8 m/s, 0.2 m in 0.5 s. The defaults are for a lively flight, with changes of 4
  /// m/s^2 and 1.5 rad/s in a quarter of a second.
  double gap_gyro_walk = 3.0;   ///< rad/s/sqrt(s)
  double gap_accel_walk = 8.0;  ///< m/s^2/sqrt(s)

  /// All must be positive: an interval without noise has no finite information.
  [[nodiscard]] Status Validate() const {
    if (Status s = ValidatePositive(gyro_noise_density, "gyro_noise_density"); !s.ok()) return s;
    if (Status s = ValidatePositive(accel_noise_density, "accel_noise_density"); !s.ok()) return s;
    if (Status s = ValidatePositive(gyro_random_walk, "gyro_random_walk"); !s.ok()) return s;
    if (Status s = ValidatePositive(accel_random_walk, "accel_random_walk"); !s.ok()) return s;
    if (Status s = ValidatePositive(saturation_inflation, "saturation_inflation"); !s.ok()) {
      return s;
    }
    if (max_gap_ns <= 0) return {StatusCode::kNotPositive, "max_gap_ns must be > 0"};
    if (gaps != ImuGaps::kInflate && gaps != ImuGaps::kRefuse) {
      return {StatusCode::kInvalidArgument, "gaps is none of ImuGaps"};
    }
    if (Status s = ValidatePositive(gap_gyro_walk, "gap_gyro_walk"); !s.ok()) return s;
    return ValidatePositive(gap_accel_walk, "gap_accel_walk");
  }
};

/// Biases of accelerometer (m/s^2) and gyroscope (rad/s): a sample is truth + bias + noise.
struct ImuBias {
  Vector3 ba = Vector3::Zero();
  Vector3 bg = Vector3::Zero();
};

}  // namespace glissade
