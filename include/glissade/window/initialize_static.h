// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/window/init_verdict.h"
#include "glissade/window/observation.h"
#include "glissade/window/stillness.h"

namespace glissade {

struct StaticOptions {
  StillnessOptions stillness;
  ImuBiasPrior bias_prior;
  double gravity = 9.81;  ///< |g|, m/s^2
  /// What the cameras saw meanwhile; may be empty, then the IMU decides alone.
  std::span<const WindowCamera> cameras;
  std::span<const FrameObservations> frames;

  [[nodiscard]] Status Validate() const;
};

/// A body at rest, at the stamp of the last sample.
struct StaticState {
  std::int64_t stamp_ns = 0;
  VertexPose pose;             ///< T_W_B: at the origin, z up, yaw 0
  VertexSpeedBias speed_bias;  ///< velocity 0
  /// Of p, theta (body axes), v, ba, bg in the gauge that holds position and yaw: rows p are 0, and
  /// so is the variance of theta along the vertical. Tilt and accelerometer bias: see
  /// InitializeStatic.
  SquareMatrix<15> covariance = SquareMatrix<15>::Zero();
  StillnessTest imu;
  ImageStillnessTest images;
};

/// Where the body stands: tilt from the direction of the mean specific force f, gyroscope bias from
/// the mean rate.
///
/// A tilt and a horizontal accelerometer bias look alike, and nothing but the prior tells them
/// apart: with f = R' (0, 0, |g|) + ba + n and u = f / |f|, an error of the bias turns the estimate
/// by dtheta = u x (dba + n) / |g|. Hence cov(theta) = [u] (sigma_ba^2 + sigma_n^2) [u]' / |g|^2 (a
/// sigma of 0.2 m/s^2 is 1.2 deg), cov(theta, ba) = sigma_ba^2 [u] / |g|; along u, |f| - |g| is a
/// measurement of the bias.
///
/// Refused with the reason in *verdict (may be null) and the same in the status: what
/// TestStillness() refuses; kMoving also for a mean rate that is no bias by the prior (figure: its
/// chi2 with 3 degrees of freedom) and for images that move (figure: tracks that moved);
/// kWrongGravity where |f| differs from |g| by more than the prior of the bias allows.
[[nodiscard]] Result<StaticState> InitializeStatic(std::span<const ImuSample> samples,
                                                   const ImuNoise& noise,
                                                   const StaticOptions& options = {},
                                                   InitVerdict* verdict = nullptr);

}  // namespace glissade
