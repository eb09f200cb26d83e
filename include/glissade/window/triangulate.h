// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/lie/pose.h"

namespace glissade {

/// One sight of a point.
struct TriangulationView {
  Pose T_w_c;                    ///< camera in the world
  Vector2 uv = Vector2::Zero();  ///< (x/z, y/z)
  double sigma = 1.0;            ///< of each coordinate of uv
};

struct TriangulationOptions {
  /// Standard deviation of the distance from the first camera, as a part of that distance, up to
  /// which the point counts as known. A Gauss-Newton step from there is still worth its name.
  double max_relative_sigma = 0.3;
  /// r'r of a view in sigmas beyond which it, or the point, is wrong: 99.9 % of chi2 with 2 DoF.
  double max_chi2 = 13.8;
  double min_depth = 0.05;  ///< m, in every view
  int max_iterations = 5;
};

struct TriangulatedPoint {
  Vector3 X_w = Vector3::Zero();         ///< m
  Matrix3 covariance = Matrix3::Zero();  ///< m^2, of the views' noise with exact poses
  double relative_sigma = 0.0;           ///< of the distance from the first camera
  double parallax = 0.0;                 ///< rad, the largest angle between two of the rays
  double max_chi2 = 0.0;                 ///< of a view
};

/// The point that two or more views show, with poses taken as exact: the point nearest to all rays
/// (Hartley, Sturm, "Triangulation", CVIU 1997, Sec. 3), then Gauss-Newton on the reprojection
/// errors.
///
/// kInvalidArgument: fewer than two views, a sigma that is not positive. kNotFinite: a number that
/// is none. kSingular: the rays are parallel as far as can be seen, the distance is known worse
/// than max_relative_sigma, or there is no minimum nearby. kEvaluationFailed: the point lies behind
/// a camera or nearer than min_depth, or a view does not fit. The message has the figure.
[[nodiscard]] Result<TriangulatedPoint> Triangulate(std::span<const TriangulationView> views,
                                                    const TriangulationOptions& options = {});

}  // namespace glissade
