// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/initialize_static.h"

#include <cmath>

#include "glissade/base/validate.h"
#include "glissade/lie/so3.h"
#include "window/quantiles.h"
#include "window/upright.h"
#include "window/verdicts.h"

namespace glissade {

namespace {

using internal::Refusal;

/// What of a body that does not move is wrong nevertheless.
InitVerdict Judge(const StillnessTest& imu, const StaticOptions& options) {
  const ImuBiasPrior& prior = options.bias_prior;
  const double tail = options.stillness.false_alarm;
  const Vector3 rate = imu.rate - prior.mean.bg;
  const double rate_chi2 =
      rate.squaredNorm() / (prior.gyro_sigma * prior.gyro_sigma + imu.rate_variance);
  const double max_rate_chi2 = internal::Chi2Quantile(3, tail);
  if (!(rate_chi2 <= max_rate_chi2)) {
    return Refusal(InitReason::kMoving, rate_chi2, max_rate_chi2,
                   "chi2 of the mean rate under the prior of the bias", "");
  }
  const double off = std::abs((imu.force - prior.mean.ba).norm() - options.gravity);
  const double max_off = internal::NormalQuantile(0.5 * tail) *
                         std::sqrt(prior.accel_sigma * prior.accel_sigma + imu.force_variance);
  if (!(off <= max_off)) {
    return Refusal(InitReason::kWrongGravity, off, max_off,
                   "mean specific force, away from |g| by what", "m/s^2");
  }
  return {};
}

/// u is not quite the vertical: what gravity has along it is |g| cos(tilt), which falls short of
/// |g| by b^2 / (2 |g|) for a bias b across u. This is its mean over the prior, two axes; its
/// standard deviation is the same.
double Shortfall(const StaticOptions& options) {
  return options.bias_prior.accel_sigma * options.bias_prior.accel_sigma / options.gravity;
}

/// Position and yaw are held; see the header for tilt and bias.
SquareMatrix<15> CovarianceAtRest(const Vector3& u, const StillnessTest& imu,
                                  const StaticOptions& options) {
  const double s2 = options.bias_prior.accel_sigma * options.bias_prior.accel_sigma;
  const double n2 = imu.force_variance;
  const double l2 = n2 + Shortfall(options) * Shortfall(options);
  const Matrix3 turn = so3::Hat(u) / options.gravity;  // d theta / d ba
  const Matrix3 along = u * u.transpose();
  SquareMatrix<15> C = SquareMatrix<15>::Zero();
  C.block<3, 3>(3, 3) = (s2 + n2) * turn * turn.transpose();
  C.block<3, 3>(3, 9) = s2 * turn;
  C.block<3, 3>(9, 3) = s2 * turn.transpose();
  C.block<3, 3>(6, 6) =
      options.stillness.tremble_speed * options.stillness.tremble_speed * Matrix3::Identity();
  C.block<3, 3>(9, 9) = s2 * (Matrix3::Identity() - along) + s2 * l2 / (s2 + l2) * along;
  const double p2 = options.bias_prior.gyro_sigma * options.bias_prior.gyro_sigma;
  C.block<3, 3>(12, 12) = p2 * imu.rate_variance / (p2 + imu.rate_variance) * Matrix3::Identity();
  return C;
}

}  // namespace

Status StaticOptions::Validate() const {
  if (Status s = stillness.Validate(); !s.ok()) return s;
  if (Status s = bias_prior.Validate(); !s.ok()) return s;
  return ValidatePositive(gravity, "gravity");
}

Result<StaticState> InitializeStatic(std::span<const ImuSample> samples, const ImuNoise& noise,
                                     const StaticOptions& options, InitVerdict* verdict) {
  InitVerdict unused;
  InitVerdict& judged = verdict ? *verdict : unused;
  if (Status s = options.Validate(); !s.ok()) {
    judged = internal::InvalidInput(s);
    return s;
  }
  StaticState state;
  state.imu = TestStillness(samples, noise, options.stillness);
  judged = state.imu.verdict;
  if (judged.ok()) judged = Judge(state.imu, options);
  if (judged.ok() && !options.frames.empty()) {
    state.images = TestImageStillness(options.cameras, options.frames, options.stillness);
    if (state.images.verdict.reason != InitReason::kTooFewTracks) judged = state.images.verdict;
  }
  if (!judged.ok()) return judged.ToStatus();

  const ImuBiasPrior& prior = options.bias_prior;
  const Vector3 force = state.imu.force - prior.mean.ba;
  const Vector3 u = force.normalized();
  state.stamp_ns = samples.back().stamp_ns;
  state.pose.pose = Pose(internal::UprightWithoutYaw(u), Vector3::Zero());
  // Along u the length of the force speaks of the bias; the prior has the rest. So has it a little
  // of a rate that was measured.
  const double s2 = prior.accel_sigma * prior.accel_sigma;
  const double p2 = prior.gyro_sigma * prior.gyro_sigma;
  const double shortfall = Shortfall(options);
  const double accel_gain = s2 / (s2 + state.imu.force_variance + shortfall * shortfall);
  const double gyro_gain = p2 / (p2 + state.imu.rate_variance);
  state.speed_bias =
      VertexSpeedBias(Vector3::Zero(),
                      prior.mean.ba + accel_gain * (force.norm() - options.gravity + shortfall) * u,
                      prior.mean.bg + gyro_gain * (state.imu.rate - prior.mean.bg));
  state.covariance = CovarianceAtRest(u, state.imu, options);
  return state;
}

}  // namespace glissade
