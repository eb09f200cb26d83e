// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "glissade/base/status.h"
#include "glissade/imu/noise.h"

/// \file
/// What an initialisation says beside its state: why it refused, and by which number.
namespace glissade {

enum class InitReason : std::uint8_t {
  kOk,
  kInvalidInput,    ///< options, cameras or stamps that make no sense; figure unused
  kNotFinite,       ///< a NaN or infinity in what was measured; figure: index of the sample
  kTooFewSamples,   ///< of the IMU; figure: seconds that they span
  kImuGap,          ///< figure: seconds without a reading
  kImuSaturated,    ///< figure: number of samples
  kWrongGravity,    ///< figure: | |specific force| - |g| |, m/s^2
  kMoving,          ///< not at rest; figure: chi2 of the test that said so
  kTooFewFrames,    ///< figure: frames
  kTooFewTracks,    ///< figure: tracks that can be used
  kStandingStill,   ///< nothing moves, nothing to align; figure: chi2 of the test of stillness
  kRotationOnly,    ///< the camera turns on the spot; figure: see InitializeInMotion
  kNoAcceleration,  ///< gravity, velocity or scale stays open; figure: the sigma that is too large
  kNotConverged,    ///< vision and IMU do not fit together; figure: chi2 per degree of freedom
};

/// "ok", "IMU gap", ...
std::string_view ToString(InitReason reason);

/// Why, and the number it was judged by: `figure` was held against `limit`.
struct InitVerdict {
  InitReason reason = InitReason::kOk;
  double figure = 0.0;
  double limit = 0.0;
  std::string message;  ///< one line for people; empty when ok

  [[nodiscard]] bool ok() const { return reason == InitReason::kOk; }
  /// kNotFinite, kSingular where something is unobservable, else kInvalidArgument.
  [[nodiscard]] Status ToStatus() const;
};

/// What is known of the biases beforehand: independent, the same sigma on each axis.
struct ImuBiasPrior {
  ImuBias mean;
  double accel_sigma = 0.2;  ///< m/s^2
  double gyro_sigma = 0.1;   ///< rad/s

  [[nodiscard]] Status Validate() const;
};

}  // namespace glissade
