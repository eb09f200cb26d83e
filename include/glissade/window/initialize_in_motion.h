// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

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

/// What a first state in motion must be known to. Sigmas, of the newest frame.
struct MotionLimits {
  double gravity_sigma = 0.035;   ///< of its direction in the body, the worse axis (rad)
  double velocity_sigma = 0.3;    ///< the worst direction (m/s)
  double log_scale_sigma = 0.10;  ///< one camera: of the trajectory; 0.1 is 10 %
  /// Of all that the last refinement used: more, and model and data do not fit.
  double chi2_per_dof = 2.0;
  /// What joining the IMU may add to chi2, per degree of freedom (MotionState::imu_chi2_per_dof).
  double imu_chi2_per_dof = 3.0;
  /// Probability to doubt an IMU that is as good as its noise densities say. One that is doubted,
  /// and is within the limit above, has its covariance multiplied by what it adds.
  double false_alarm = 1.0e-4;

  [[nodiscard]] Status Validate() const;
};

/// A window of a second or two. What is not finite among the observations is left out.
struct InitializationInput {
  std::span<const WindowCamera> cameras;
  std::span<const FrameObservations> frames;  ///< stamps increase; at least 4, good are 10 to 20
  std::span<const ImuSample> imu;             ///< from the first frame to the last, or more
  ImuNoise noise;
  ImuBiasPrior bias_prior;
  double gravity = 9.81;  ///< |g|, m/s^2
  MotionLimits limits;
  StillnessOptions stillness;

  [[nodiscard]] Status Validate() const;
};

struct InitializedFrame {
  std::int64_t stamp_ns = 0;
  VertexPose pose;             ///< T_W_B
  VertexSpeedBias speed_bias;  ///< v in W
};

struct InitializedPoint {
  std::int64_t track = 0;
  Vector3 p_w = Vector3::Zero();
};

/// W has its origin in the first frame's body, z up, and that body's yaw is 0.
struct MotionState {
  std::vector<InitializedFrame> frames;  ///< all of the input, oldest first
  std::vector<InitializedPoint> points;  ///< by track number
  /// Of the newest frame: p, theta (body axes), v, ba, bg, in the gauge that holds position and yaw
  /// of the first frame. Wider where vision and IMU do not quite fit (MotionLimits::false_alarm),
  /// and so are the sigmas.
  SquareMatrix<15> covariance = SquareMatrix<15>::Zero();
  double gravity_sigma = 0.0;   ///< see MotionLimits
  double velocity_sigma = 0.0;  ///< see MotionLimits
  /// Of the logarithm of the factor that fits the positions to the truth by least squares.
  double log_scale_sigma = 0.0;
  double chi2_per_dof = 0.0;
  /// By how much chi2 rises where vision alone is joined by the IMU, over the degrees of freedom
  /// that it adds (imu_dof), and over vision's own chi2 per degree of freedom where that exceeds 1.
  double imu_chi2_per_dof = 0.0;
  int imu_dof = 0;
  bool stereo = false;   ///< two cameras see the same points at the same time
  int observations = 0;  ///< that the last refinement used
  int outliers = 0;      ///< observations left out by it
};

/// First state of a body in motion from a window of frames and its IMU samples.
///
/// Vision first: with stereo, points from pairs, each frame located in those (its rotation
/// predicted by the gyroscope), a bundle adjustment. With one camera, the relative pose of two
/// frames (five points, RANSAC with fixed seed), the others located in what these see, a bundle
/// adjustment up to scale. Then the gyroscope's bias from the rotations, and velocities, gravity of
/// known length and, with one camera, scale by linear least squares. Then all states and points are
/// refined together with IMU factors, without a robust loss on what fits, and the covariance of
/// that decides: a state is returned if its gravity, velocity and scale are known to the limits.
///
/// Refused with the reason in *verdict (may be null) and the same in the status: kInvalidInput,
/// kNotFinite (IMU), kTooFewFrames, kTooFewSamples, kImuGap, kTooFewTracks; kStandingStill where
/// both tests of stillness pass: InitializeStatic is for that. One camera: kRotationOnly where the
/// images are explained by a rotation alone (figure: tracks that are not), which includes scenes
/// far away. kNoAcceleration: a sigma over its limit (figure). kNotConverged: chi2 per degree of
/// freedom, or too few observations that fit.
[[nodiscard]] Result<MotionState> InitializeInMotion(const InitializationInput& input,
                                                     InitVerdict* verdict = nullptr);

}  // namespace glissade
