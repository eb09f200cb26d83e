// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/imu/noise.h"
#include "glissade/imu/preintegration.h"

namespace glissade {

/// Errors of the increments, by Euclidean norm.
struct ImuIncrementError {
  double p = 0.0;      ///< m
  double theta = 0.0;  ///< rad
  double v = 0.0;      ///< m/s
};

/// What the first-order bias correction, Forster et al. Eq. (44), leaves out when the biases are
/// not those of the integration: terms of second order in dba, dbg for a motion of steady specific
/// force a and rotation theta over dt,
///     v: |dbg|^2 a dt^3 / 6 + |dbg| |dba| dt^2 / 2,
///     p: |dbg|^2 a dt^4 / 24 + |dbg| |dba| dt^3 / 6,
///     theta: |dbg|^2 dt^2 |theta| / 12.
/// An estimate of size, right within a small factor, and exactly 0 at the biases of integration.
[[nodiscard]] ImuIncrementError BiasCorrectionError(const ImuPreintegration& preintegration,
                                                    const ImuBias& bias);

/// Whether the samples should be integrated again at `bias`: where BiasCorrectionError exceeds
/// max_fraction of the sigma that the increments have anyway (root of a third of the trace) in
/// position, rotation or velocity. The reason for 0.1: an error of a tenth of a sigma adds 1 % of
/// one degree of freedom to Chi2, less than anything else that is neglected; and a fixed limit on
/// the bias would be wrong by the square of the interval.
[[nodiscard]] bool NeedsReintegration(const ImuPreintegration& preintegration, const ImuBias& bias,
                                      double max_fraction = 0.1);

}  // namespace glissade
