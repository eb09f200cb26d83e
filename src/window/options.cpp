// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/options.h"

#include <string>

#include "glissade/base/validate.h"
#include "glissade/losses/huber.h"

namespace glissade {

Status InitialSigmas::Validate() const {
  if (Status s = ValidatePositive(tilt, "sigma of the tilt"); !s.ok()) return s;
  if (Status s = ValidatePositive(speed, "sigma of the speed"); !s.ok()) return s;
  if (Status s = ValidatePositive(accel_bias, "sigma of the accelerometer bias"); !s.ok()) return s;
  return ValidatePositive(gyro_bias, "sigma of the gyroscope bias");
}

SlidingWindowOptions::SlidingWindowOptions() : loss(Huber{2.0}) {}

Status SlidingWindowOptions::Validate() const {
  if (cameras.empty()) return {StatusCode::kInvalidArgument, "a window needs a camera"};
  if (!imu_noise && cameras.size() < 2) {
    return {StatusCode::kInvalidArgument,
            "one camera alone does not know its scale: a window needs an IMU or a second camera"};
  }
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (const Status s = cameras[c].Validate(); !s.ok()) {
      return {s.code(),
              std::string("camera ").append(std::to_string(c)).append(": ").append(s.message())};
    }
  }
  if (imu_noise) {
    if (Status s = imu_noise->Validate(); !s.ok()) return s;
    if (Status s = imu.Validate(); !s.ok()) return s;
    if (Status s = ValidatePositive(gravity, "gravity"); !s.ok()) return s;
  }
  if (Status s = ValidatePositive(keyframes.max_parallax, "max_parallax"); !s.ok()) return s;
  if (Status s = ValidatePositive(keyframes.max_interval_s, "max_interval_s"); !s.ok()) return s;
  if (!(keyframes.min_tracked_share >= 0.0 && keyframes.min_tracked_share <= 1.0)) {
    return {StatusCode::kInvalidArgument, "min_tracked_share must be between 0 and 1"};
  }
  if (Status s = loss.Validate(); !s.ok()) return s;
  if (Status s = ValidatePositive(max_chi2, "max_chi2"); !s.ok()) return s;
  if (Status s = ValidatePositive(max_prediction_error, "max_prediction_error"); !s.ok()) return s;
  if (min_observations < 2) {
    return {StatusCode::kInvalidArgument, "min_observations must be at least 2"};
  }
  if (Status s = bias_prior.Validate(); !s.ok()) return s;
  if (Status s = stillness.Validate(); !s.ok()) return s;
  if (!(cost_tolerance >= 0.0)) {
    return {StatusCode::kInvalidArgument, "cost_tolerance must not be negative"};
  }
  if (max_frame_gap_ns <= 0) {
    return {StatusCode::kNotPositive, "max_frame_gap_ns must be > 0"};
  }
  if (Status s = ValidatePositive(max_speed, "max_speed"); !s.ok()) return s;
  if (Status s = ValidatePositive(max_bias_sigmas, "max_bias_sigmas"); !s.ok()) return s;
  if (max_failed_solves < 1) {
    return {StatusCode::kInvalidArgument, "max_failed_solves must be at least 1"};
  }
  return {};
}

}  // namespace glissade
