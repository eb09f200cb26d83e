// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/edges/preintegrated_imu.h"
#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"

/// \file
/// On-manifold preintegration: C. Forster, L. Carlone, F. Dellaert, D. Scaramuzza, "On-Manifold
/// Preintegration for Real-Time Visual-Inertial Odometry", TRO 2017. Equation numbers below are
/// its.
namespace glissade {

/// What an interval has bridged without readings (ImuNoise::max_gap_ns).
struct ImuGapReport {
  int count = 0;
  std::int64_t longest_ns =
      0;                   ///< from reading to reading, also where only a part is in the interval
  double bridged_s = 0.0;  ///< part of the interval that lies in gaps
};

/// What is known about an interval from its IMU samples alone.
struct ImuPreintegration {
  /// Increments, Eq. (33), at the biases ba_lin and bg_lin, and their derivatives by the biases,
  /// Eqs. (44), (69).
  PreintegratedImu imu;
  /// Covariance of the residual of EdgeImu, order p, theta, v, ba, bg; Eqs. (62), (63) with the
  /// random walk of the biases, Eq. (47), as six more states.
  SquareMatrix<15> covariance = SquareMatrix<15>::Zero();
  double mean_accel = 0.0;  ///< |specific force| less bias, mean over the interval (m/s^2)
  ImuGapReport gaps;        ///< the covariance allows for these
};

/// Integrates sample by sample.
///
/// Between two samples, angular rate and specific force are taken as linear in time, where Forster
/// et al. hold them constant. Rotation: Magnus series to fourth order (for a linear rate:
/// phi = (w0 + w1) h / 2 + (w0 x w1) h^2 / 12). Velocity and position: Simpson's rule. The error of
/// a step h is O(h^5); what remains, O(h^2), is that samples are no more than samples. Covariance
/// and bias Jacobians are the exact derivatives of these steps.
///
/// Where a step is a gap or, between samples that were interpolated, a part of one, the covariance
/// has the motion that nobody saw added to it, or the step is refused: ImuNoise::gaps.
class ImuPreintegrator {
 public:
  ImuPreintegrator() = default;

  /// Begins at a first sample. Refuses noise that is not positive, and what is not finite; then
  /// Add() is refused, too.
  Status Start(const ImuSample& first, const ImuBias& bias, const ImuNoise& noise);
  /// The interval from the previous sample to this one. Refuses a stamp that is not later
  /// (kInvalidArgument), values, also results, that are not finite (kNotFinite), and a gap
  /// (kInvalidArgument) with ImuGaps::kRefuse; then what was integrated stays as it was.
  Status Add(const ImuSample& sample);

  /// imu.dt is 0 before the first Add().
  [[nodiscard]] const ImuPreintegration& Get() const { return integral_; }

 private:
  ImuNoise noise_;
  ImuSample last_;
  bool started_ = false;
  ImuPreintegration integral_;
};

/// The whole interval from the first to the last of at least two samples.
[[nodiscard]] Result<ImuPreintegration> Preintegrate(std::span<const ImuSample> samples,
                                                     const ImuBias& bias, const ImuNoise& noise);

}  // namespace glissade
