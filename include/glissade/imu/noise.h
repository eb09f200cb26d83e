// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/matrix.h"
#include "glissade/base/validate.h"

namespace glissade {

/// Noise of an IMU in continuous time, as data sheets and Kalibr give it. The noise of one sample
/// has sigma = density * sqrt(rate).
struct ImuNoise {
  double gyro_noise_density = 1.7e-4;   ///< rad/s/sqrt(Hz)
  double accel_noise_density = 2.0e-3;  ///< m/s^2/sqrt(Hz)
  double gyro_random_walk = 2.0e-5;     ///< of the bias, rad/s^2/sqrt(Hz)
  double accel_random_walk = 3.0e-3;    ///< of the bias, m/s^3/sqrt(Hz)
  /// A saturated sample has this many times the sigma: the sensor says "at least this much".
  double saturation_inflation = 100.0;

  /// All must be positive: an interval without noise has no finite information.
  [[nodiscard]] Status Validate() const {
    if (Status s = ValidatePositive(gyro_noise_density, "gyro_noise_density"); !s.ok()) return s;
    if (Status s = ValidatePositive(accel_noise_density, "accel_noise_density"); !s.ok()) return s;
    if (Status s = ValidatePositive(gyro_random_walk, "gyro_random_walk"); !s.ok()) return s;
    if (Status s = ValidatePositive(accel_random_walk, "accel_random_walk"); !s.ok()) return s;
    return ValidatePositive(saturation_inflation, "saturation_inflation");
  }
};

/// Biases of accelerometer (m/s^2) and gyroscope (rad/s): a sample is truth + bias + noise.
struct ImuBias {
  Vector3 ba = Vector3::Zero();
  Vector3 bg = Vector3::Zero();
};

}  // namespace glissade
