// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "glissade/sim/vi_problem.h"

namespace glissade::app {

/// A position in the plane of x and y with its covariance (m^2).
struct GaugeEllipse {
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
};

/// Covariances of [p, theta, v] of all keyframes: of a free solve, carried over to the fixed gauge,
/// and of a fixed solve of its own. Both run to convergence.
struct GaugeCovariances {
  int keyframes = 0;
  /// |transformed - fixed| / |fixed|, Frobenius, over everything.
  double relative_error = 0.0;
  /// Where "free" is from: the pseudo-inverse of the whole H.
  int size = 0;                                  ///< 9 per keyframe
  std::vector<double> free, transformed, fixed;  ///< size x size
  std::vector<GaugeEllipse> free_ellipses, transformed_ellipses, fixed_ellipses;
};

Result<GaugeCovariances> CompareCovariances(const sim::ViProblem& problem);

}  // namespace glissade::app
