// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/base/matrix.h"
#include "glissade/imu/buffer.h"
#include "glissade/imu/preintegration.h"
#include "glissade/lie/pose.h"
#include "glissade/window/initialize_in_motion.h"

/// \file
/// Vision and IMU in one frame: what a window's poses and its preintegrated terms say of biases,
/// velocities, gravity and scale.
namespace glissade::internal {

/// The IMU between neighbouring frames, kept to be integrated again at other biases.
class InertialTerms {
 public:
  /// kTooFewSamples, kImuGap, ... where the samples do not cover the frames.
  InitVerdict Cut(const InitializationInput& input);
  Status Integrate(const ImuBias& bias);

  [[nodiscard]] const std::vector<ImuPreintegration>& terms() const { return terms_; }

 private:
  ImuNoise noise_;
  std::vector<ImuInterval> intervals_;
  std::vector<ImuPreintegration> terms_;
};

/// The gyroscope's bias from rotations R_V_B of the frames, each good to sigma_rotation (rad):
/// least squares on Log((dq Exp(dq_dbg dbg))' R_k' R_{k+1}), with the prior. The increments are
/// those of `terms`; the bias is absolute.
Vector3 AlignGyroBias(const std::vector<ImuPreintegration>& terms, const std::vector<Pose>& T_v_b,
                      const ImuBiasPrior& prior, double sigma_rotation);

struct Alignment {
  bool ok = false;
  std::vector<Vector3> velocities;    ///< of the body in V
  Vector3 gravity = Vector3::Zero();  ///< acceleration in V, of the given length
  Vector3 ba = Vector3::Zero();
  double scale = 1.0;
  double relative_scale_sigma = 0.0;
};

/// Velocity, gravity, accelerometer bias and, unless `metric`, scale in closed form. With rotations
/// given, all positions of the body are linear in where it starts, how fast, gravity, and the bias;
/// the rig's centres c_k as seen are those over the scale s, so that with lambda = 1 / s
///     c_k = a + b t_k + lambda (g t_k^2 / 2 + alpha_k + A_k dba),
///     alpha_k = sum_j<k (R_j dp_j + (t_k - t_j+1) R_j dv_j) + R_k l,
/// is linear in a, b, lambda g, lambda, lambda dba; l is the rig's place in the body. What is
/// noisy, c, stands on the left alone: with the scale before differences of c instead, their noise
/// would pull it to zero. Then |g| is held, and its direction found on the tangent plane.
/// sigma_centre: of c, in the units of V. (After A. Martinelli, "Closed-Form Solution of
/// Visual-Inertial Structure from Motion", IJCV 2014.)
Alignment AlignLinear(const std::vector<ImuPreintegration>& terms, const std::vector<Pose>& T_v_r,
                      const Pose& T_b_r, bool metric, double sigma_centre,
                      const ImuBiasPrior& prior, double gravity);

}  // namespace glissade::internal
