// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/base/matrix.h"

namespace glissade::internal {

/// A point in two images, (x/z, y/z).
struct TwoViewMatch {
  double x1 = 0.0, y1 = 0.0, x2 = 0.0, y2 = 0.0;
};

struct TwoViewMotion {
  bool ok = false;
  Matrix3 R = Matrix3::Identity();           ///< x2 ~ R x1 + t
  Vector3 t = Vector3(1.0, 0.0, 0.0);        ///< unit; without meaning where there is no parallax
  Matrix3 covariance = Matrix3::Identity();  ///< of dphi in R <- Exp(dphi) R
  double noise = 0.0;                        ///< sigma of what fits, in those given
  int outliers = 0;
};

/// Distance of a match from the epipolar geometry (R, t) in sigmas, to first order (Sampson).
/// sigma_x, sigma_y: of a coordinate, in both images.
double EpipolarError(const Matrix3& R, const Vector3& t, const TwoViewMatch& m, double sigma_x,
                     double sigma_y);

/// Relative rotation of one camera between two images, with a direction of translation on the side.
/// No guess is needed and none of the motion between is used but that the rotation is less than
/// about half a radian. Random samples of five matches (iterated, after V. Lui and T. Drummond, "An
/// iterative 5-pt algorithm for fast and robust essential matrix estimation", BMVC 2013) beside
/// fits of all; the least median of errors wins, whatever their scale, and is refined on all that
/// fit it. Not ok with fewer than 12 matches, or with fewer than ten or less than two fifths that
/// fit. The same input and seed give the same result.
TwoViewMotion EstimateTwoView(const std::vector<TwoViewMatch>& matches, double sigma_x,
                              double sigma_y, std::uint64_t seed);

/// The fit of all matches that begins at R, t, robust; the matches of a stereo pair with its given
/// extrinsics. Not ok with fewer than 12.
TwoViewMotion RefineTwoView(const std::vector<TwoViewMatch>& matches, double sigma_x,
                            double sigma_y, const Matrix3& R, const Vector3& t);

/// Epipolar errors of a pair of images at a given rotation, in the best direction of translation:
/// robust cost, and what is left of its gradient and information about dphi in R <- Exp(dphi) R
/// when the direction is eliminated.
struct EpipolarSum {
  double cost = 0.0;
  Vector3 gradient = Vector3::Zero();
  Matrix3 information = Matrix3::Zero();
};
/// Begins at t, which is improved in so many iterations.
EpipolarSum SumEpipolar(const std::vector<TwoViewMatch>& matches, double sigma_x, double sigma_y,
                        const Matrix3& R, int iterations, Vector3* t);

/// At most so many, evenly.
std::vector<TwoViewMatch> SomeOf(const std::vector<TwoViewMatch>& matches, std::size_t most);

/// Sigma of errors (their absolute values) of which fewer than half are outliers.
double RobustSigma(std::vector<double> errors);

}  // namespace glissade::internal
