// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/base/matrix.h"
#include "window/doctor.h"

namespace glissade::internal {

/// The gyroscope against the relative rotations of one camera,
///   Log(R_c0_c1) = scale * R_b_c' Log(R_b(t0 + S)' R_b(t1 + S)),
/// R_b integrated from sign * (reading less bias).
struct GyroFit {
  bool ok = false;
  int pairs = 0;
  double rotation_rms = 0.0;  ///< of the pairs about their mean rate (rad), ...
  double noise_rms = 0.0;     ///< ... and what tracks know it to
  double correlation = 0.0;   ///< at the best offset, 0 to 1
  double unit = 1.0;          ///< rad/s a unit of the recording: 1 or pi / 180 or its inverse
  double sign = 1.0;          ///< -1: mirrored axes, a reading is -R true

  Matrix3 R_b_c = Matrix3::Identity();
  double time_offset_s = 0.0;
  Vector3 bias = Vector3::Zero();
  double scale = 1.0;
  /// Order: rotation d of R_b_c <- Exp(d) R_b_c, time offset, bias, log of scale. Scaled by how
  /// well the model fits.
  SquareMatrix<8> covariance = SquareMatrix<8>::Identity();
  double misfit = 0.0;  ///< scale of the residuals in their expected sigmas
};

/// Needs nothing but a range for S; the given R_b_c says which rotation to take where motion leaves
/// some of it open. Coarse: correlation of rates, by grid over S (the best rotation of each:
/// Wahba's problem by SVD); then robust Gauss-Newton. Not ok with fewer than ten pairs, or without
/// rotation.
GyroFit FitGyroToPairs(const DoctorCase& c, int camera);

}  // namespace glissade::internal
