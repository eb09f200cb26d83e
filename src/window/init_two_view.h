// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "glissade/base/matrix.h"
#include "glissade/lie/pose.h"

/// \file
/// Relative pose of two views of one camera.
namespace glissade::internal {

/// One track in both views, on normalized coordinates.
struct Match {
  Vector2 a = Vector2::Zero(), b = Vector2::Zero();
};

/// An essential matrix, row-major, of unit norm.
using Essential = std::array<double, 9>;

/// Essential matrices E with (b, 1)' E (a, 1) = 0 for five matches; up to ten. D. Nister, "An
/// Efficient Solution to the Five-Point Relative Pose Problem" (PAMI 2004), its equations solved by
/// the action matrix of H. Stewenius, C. Engels, D. Nister, "Recent Developments on Direct Relative
/// Orientation" (ISPRS 2006).
void FivePoint(const Match matches[5], std::vector<Essential>* essentials);

struct RelativePose {
  bool ok = false;
  Matrix3 R_b_a = Matrix3::Identity();  ///< x_b = R_b_a x_a + t
  Vector3 t = Vector3::UnitX();         ///< of unit length
  int inliers = 0;
};

/// RANSAC over FivePoint with a fixed seed: the same matches give the same pose. `sigma` is that of
/// a coordinate; expected, of which the rotation is used, is what the gyroscope says, good to
/// max_angle (rad): other rotations are not looked at. A match fits within 3 sigma (Sampson's
/// distance).
RelativePose FindRelativePose(const std::vector<Match>& matches, double sigma, const Pose& expected,
                              double max_angle);

/// How well a rotation alone explains matches: the best one by least squares with Cauchy weights,
/// from that of start.
struct RotationFit {
  /// Matches whose distance, in units of its variance, is over the median of chi2 with 2 degrees
  /// of freedom. With nothing but noise: a half.
  int moved = 0;
  double median = 0.0;  ///< distance, in units of its sigma
};
RotationFit FitRotation(const std::vector<Match>& matches, double sigma, const Pose& start);

}  // namespace glissade::internal
