// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/init_two_view.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/fixed_draw.h"
#include "glissade/lie/so3.h"

namespace glissade::internal {

namespace {

constexpr double kChi2Median = 1.38629436;  // 2 degrees of freedom
constexpr int kMaxTrials = 300;

Eigen::Vector3d Homogeneous(const Vector2& x) {
  return {x[0], x[1], 1.0};
}

/// Square of Sampson's distance.
double Sampson2(const Eigen::Matrix3d& E, const Match& m) {
  const Eigen::Vector3d a = Homogeneous(m.a), b = Homogeneous(m.b);
  const Eigen::Vector3d Ea = E * a, Etb = E.transpose() * b;
  const double c = b.dot(Ea);
  return c * c / (Ea.head<2>().squaredNorm() + Etb.head<2>().squaredNorm());
}

/// Whether the point of a match lies before both cameras.
bool InFront(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const Match& m) {
  // lambda_b b = lambda_a R a + t, by least squares.
  const Eigen::Vector3d Ra = R * Homogeneous(m.a), b = Homogeneous(m.b);
  const double aa = Ra.squaredNorm(), ab = Ra.dot(b), bb = b.squaredNorm();
  const double at = Ra.dot(t), bt = b.dot(t);
  const double det = aa * bb - ab * ab;  // >= 0
  return ab * bt - bb * at > 0.0 && aa * bt - ab * at > 0.0 && det > 0.0;
}

/// The rotation and translation of E that fit what is expected and see the points before them.
RelativePose Decompose(const Eigen::Matrix3d& E, const std::vector<Match>& matches,
                       double max_distance2, const Eigen::Matrix3d& R_expected, double max_angle) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(E, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU(), V = svd.matrixV();
  if (U.determinant() < 0.0) U.col(2) *= -1.0;
  if (V.determinant() < 0.0) V.col(2) *= -1.0;
  Eigen::Matrix3d W;
  W << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  RelativePose best;
  for (const Eigen::Matrix3d& R : {Eigen::Matrix3d(U * W * V.transpose()),
                                   Eigen::Matrix3d(U * W.transpose() * V.transpose())}) {
    const double angle = so3::Log(Matrix3(R * R_expected.transpose())).norm();
    if (!(angle < max_angle)) continue;
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d t = sign * U.col(2);
      int inliers = 0;
      for (const Match& m : matches) {
        if (Sampson2(E, m) < max_distance2 && InFront(R, t, m)) ++inliers;
      }
      if (inliers > best.inliers) best = {true, Matrix3(R), Vector3(t), inliers};
    }
  }
  return best;
}

}  // namespace

RelativePose FindRelativePose(const std::vector<Match>& matches, double sigma, const Pose& expected,
                              double max_angle) {
  RelativePose best;
  const Matrix3 R_expected = expected.R();
  if (matches.size() < 8) return best;
  const double max_distance2 = 9.0 * sigma * sigma;
  FixedDraw draw;
  std::vector<Essential> essentials;
  double best_cost = 1e300, trials = kMaxTrials;
  for (int trial = 0; trial < trials; ++trial) {
    std::array<std::size_t, 5> picked{};
    std::array<Match, 5> sample;
    for (std::size_t k = 0; k < 5; ++k) {
      do {
        picked[k] = draw.Below(matches.size());
      } while (std::find(picked.begin(), picked.begin() + k, picked[k]) != picked.begin() + k);
      sample[k] = matches[picked[k]];
    }
    FivePoint(sample.data(), &essentials);
    for (const Essential& candidate : essentials) {
      const Eigen::Matrix3d E(Eigen::Map<const Matrix3>(candidate.data()));
      double cost = 0.0;
      for (const Match& m : matches) {
        cost += std::min(Sampson2(E, m), max_distance2);
        if (!(cost < best_cost)) break;
      }
      if (!(cost < best_cost)) continue;
      const RelativePose pose = Decompose(E, matches, max_distance2, R_expected, max_angle);
      // More than a half behind a camera: not this one.
      if (!pose.ok || 2 * pose.inliers < static_cast<int>(matches.size())) continue;
      best = pose;
      best_cost = cost;
      // Enough for a sample without an outlier with 99.9 %, and five times that for the noise.
      const double share = static_cast<double>(pose.inliers) / static_cast<double>(matches.size());
      const double clean = std::pow(share, 5.0);
      if (clean < 1.0 - 1e-9) {
        trials = std::min(double{kMaxTrials}, 5.0 * std::log(1e-3) / std::log(1.0 - clean));
      }
      trials = std::max(trials, 20.0);
    }
  }
  return best;
}

RotationFit FitRotation(const std::vector<Match>& matches, double sigma, const Pose& start) {
  Eigen::Matrix3d R = start.R();
  // Residual of b against R a on the image plane; d/d(left rotation vector) as of a pinhole.
  const auto residual = [&](const Match& m, Eigen::Matrix<double, 2, 3>* J) {
    const Eigen::Vector3d c = R * Homogeneous(m.a);
    if (J) {
      Eigen::Matrix<double, 2, 3> P;
      P << 1.0 / c[2], 0.0, -c[0] / (c[2] * c[2]), 0.0, 1.0 / c[2], -c[1] / (c[2] * c[2]);
      *J = -P * Eigen::Matrix3d(so3::Hat(Vector3(c)));
    }
    return Eigen::Vector2d(Eigen::Vector2d(c[0] / c[2], c[1] / c[2]) - m.b);
  };
  const double variance = 2.0 * sigma * sigma;
  // From a wide loss, as the start may be off by degrees, to a narrow one.
  for (int iteration = 0; iteration < 12; ++iteration) {
    const double width2 = variance * std::max(4.0, 4e4 * std::pow(0.1, iteration));
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const Match& m : matches) {
      Eigen::Matrix<double, 2, 3> J;
      const Eigen::Vector2d r = residual(m, &J);
      const double weight = 1.0 / (1.0 + r.squaredNorm() / width2);
      H += weight * J.transpose() * J;
      g += weight * J.transpose() * r;
    }
    const Eigen::Vector3d step = H.ldlt().solve(g);
    if (!step.allFinite()) break;
    R = Eigen::Matrix3d(so3::Exp(Vector3(-step))) * R;
  }
  RotationFit fit;
  std::vector<double> chi2;
  for (const Match& m : matches) {
    chi2.push_back(residual(m, nullptr).squaredNorm() / variance);
    if (!(chi2.back() <= kChi2Median)) ++fit.moved;
  }
  if (chi2.empty()) return fit;
  const auto middle = chi2.begin() + static_cast<std::ptrdiff_t>(chi2.size() / 2);
  std::nth_element(chi2.begin(), middle, chi2.end());
  fit.median = std::sqrt(*middle);
  return fit;
}

}  // namespace glissade::internal
