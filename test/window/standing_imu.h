// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"
#include "glissade/lie/so3.h"
#include "glissade/sim/noise_source.h"

namespace glissade::test {

/// A body that does not move, read by a noisy IMU at 200 Hz.
struct StandingImu {
  Matrix3 R_w_b = Matrix3::Identity();
  ImuBias bias;
  double seconds = 1.0;
  /// Of rotors: amplitudes of a shaking near 97 Hz, which is close to the half of 200 Hz, as an
  /// IMU sees it.
  double shake_accel = 0.0;  ///< m/s^2
  double shake_gyro = 0.0;   ///< rad/s
  std::uint64_t seed = 1;

  /// *bias_at_end: after its walk.
  [[nodiscard]] std::vector<ImuSample> Read(const ImuNoise& noise,
                                            ImuBias* bias_at_end = nullptr) const {
    constexpr double kRate = 200.0;
    sim::NoiseSource random(seed, 77);
    ImuBias b = bias;
    std::vector<ImuSample> samples;
    const int count = 1 + static_cast<int>(std::lround(seconds * kRate));
    for (int k = 0; k < count; ++k) {
      if (k > 0) {
        b.ba += random.Normal3(noise.accel_random_walk / std::sqrt(kRate));
        b.bg += random.Normal3(noise.gyro_random_walk / std::sqrt(kRate));
      }
      const double phase = 2.0 * std::numbers::pi * 97.0 * k / kRate;
      ImuSample s;
      s.stamp_ns = 1'000'000'000 + std::int64_t{5'000'000} * k;
      s.gyro = b.bg + random.Normal3(noise.gyro_noise_density * std::sqrt(kRate)) +
               shake_gyro * Vector3(std::sin(phase), std::cos(phase), std::sin(phase + 1.0));
      s.accel = R_w_b.transpose() * Vector3(0.0, 0.0, 9.81) + b.ba +
                random.Normal3(noise.accel_noise_density * std::sqrt(kRate)) +
                shake_accel * Vector3(std::cos(phase), std::sin(phase + 2.0), std::sin(phase));
      samples.push_back(s);
    }
    if (bias_at_end) *bias_at_end = b;
    return samples;
  }
};

}  // namespace glissade::test
