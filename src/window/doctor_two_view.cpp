// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/doctor_two_view.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "glissade/lie/so3.h"
#include "window/doctor.h"
#include "window/doctor_epipolar.h"

namespace glissade::internal {

namespace {

using epipolar::Epipolar, epipolar::Motion, epipolar::Noise;
using epipolar::First, epipolar::Second, epipolar::TangentsAt;
using Vector5 = Vector<5>;
using Matrix5 = SquareMatrix<5>;

void Step(const Vector5& d, const Matrix<3, 2>& b, Motion* motion) {
  motion->R = so3::Exp(Vector3(d.head<3>())) * motion->R;
  motion->t = (motion->t + b * d.tail<2>()).normalized();
}

/// Iterated fit of some matches with Cauchy's weights of a width in sigmas (0: none). The
/// information comes back where it is asked for. A weak prior holds the translation where the
/// rotation alone explains the matches.
void Fit(const std::vector<TwoViewMatch>& matches, const Noise& noise, double width, int iterations,
         Motion* motion, Matrix5* information = nullptr) {
  for (int k = 0; k < iterations; ++k) {
    const Matrix<3, 2> b = TangentsAt(motion->t);
    Matrix5 H = Matrix5::Zero();
    Vector5 g = Vector5::Zero();
    for (const TwoViewMatch& m : matches) {
      const Epipolar at(*motion, m, noise);
      const double e = at.error;
      Vector3 by_rotation, by_translation;
      at.Derivatives(*motion, &by_rotation, &by_translation);
      Vector5 J;
      J.head<3>() = by_rotation;
      J.tail<2>() = b.transpose() * by_translation;
      const double w = width > 0.0 ? 1.0 / (1.0 + e * e / (width * width)) : 1.0;
      H += w * J * J.transpose();
      g += w * e * J;
    }
    H.diagonal().head<3>().array() += 1e-6 * H.diagonal().head<3>().maxCoeff() + 1e-12;
    H.diagonal().tail<2>().array() += 1.0;
    Vector5 d = -(H.ldlt().solve(g));
    const double length = d.norm();
    if (!std::isfinite(length)) return;
    if (length > 0.5) d *= 0.5 / length;
    if (information != nullptr) *information = H;
    Step(d, b, motion);
    if (length < 1e-6) return;
  }
}

/// The rotation that alone explains the matches best: flow of far points.
Matrix3 RotationAlone(const std::vector<TwoViewMatch>& matches) {
  Matrix3 R = Matrix3::Identity();
  double width = 0.1;
  for (int k = 0; k < 8; ++k, width = std::max(0.5 * width, 0.01)) {
    Matrix3 H = 1e-9 * Matrix3::Identity();
    Vector3 g = Vector3::Zero();
    for (const TwoViewMatch& m : matches) {
      const Vector3 y = (R * First(m)).normalized(), f = Second(m).normalized();
      const Vector3 e = y - f;
      const double w = 1.0 / (1.0 + e.squaredNorm() / (width * width));
      const Matrix3 J = -so3::Hat(y);
      H += w * J.transpose() * J;
      g += w * J.transpose() * e;
    }
    Vector3 d = -(H.ldlt().solve(g));
    if (!d.allFinite()) break;
    if (d.norm() > 0.5) d *= 0.5 / d.norm();
    R = so3::Exp(d) * R;
  }
  return R;
}

std::vector<double> ErrorsOf(const std::vector<TwoViewMatch>& matches, const Motion& motion,
                             const Noise& noise) {
  std::vector<double> errors;
  errors.reserve(matches.size());
  for (const TwoViewMatch& m : matches)
    errors.push_back(std::abs(Epipolar(motion, m, noise).error));
  return errors;
}

/// The best of several candidates. First by the median of errors, whatever their scale; then, where
/// the noise is known by that, by the sum of Tukey's losses, which tells better between minima that
/// lie close together.
class Best {
 public:
  Best(const std::vector<TwoViewMatch>& matches, const Noise& noise)
      : matches_(matches), noise_(noise) {}
  void Try(const Motion& motion) {
    candidates_.push_back({motion, ErrorsOf(matches_, motion, noise_)});
    sigma_ = std::min(sigma_, RobustSigma(candidates_.back().errors));
  }
  [[nodiscard]] double sigma() const { return sigma_; }
  [[nodiscard]] Motion motion() const {
    const double width = 4.685 * std::max(sigma_, 1e-3);
    double least = std::numeric_limits<double>::infinity();
    Motion best;
    for (const Candidate& c : candidates_) {
      double cost = 0.0;
      for (const double e : c.errors) {
        const double rest = std::max(1.0 - e * e / (width * width), 0.0);
        cost += 1.0 - rest * rest * rest;
      }
      if (cost < least) {
        least = cost;
        best = c.motion;
      }
    }
    return best;
  }

 private:
  struct Candidate {
    Motion motion;
    std::vector<double> errors;
  };
  const std::vector<TwoViewMatch>& matches_;
  Noise noise_;
  std::vector<Candidate> candidates_;
  double sigma_ = std::numeric_limits<double>::infinity();
};

/// All that fits a motion of which sigma is known.
TwoViewMotion Refine(const std::vector<TwoViewMatch>& matches, const Noise& noise, Motion motion,
                     double sigma) {
  TwoViewMotion result;
  const std::size_t n = matches.size();
  std::vector<TwoViewMatch> inliers;
  Matrix5 H = Matrix5::Identity();
  for (int k = 0; k < 3; ++k) {
    // Noise-free tracks have errors of rounding alone: they all fit.
    const double limit = std::max(3.5 * sigma, 1e-3);
    const std::vector<double> errors = ErrorsOf(matches, motion, noise);
    inliers.clear();
    for (std::size_t i = 0; i < n; ++i) {
      if (errors[i] <= limit) inliers.push_back(matches[i]);
    }
    if (inliers.size() < 10 || 5 * inliers.size() < 2 * n) return result;
    Fit(inliers, noise, std::max(2.0 * sigma, 1e-3), 6, &motion, &H);
    sigma = RobustSigma(ErrorsOf(inliers, motion, noise));
  }
  result.noise = sigma;
  result.outliers = static_cast<int>(n - inliers.size());
  result.R = motion.R;
  result.t = motion.t;
  const double scale = std::max(sigma, 0.05);
  result.covariance = scale * scale * Matrix3(H.inverse().topLeftCorner<3, 3>());
  result.ok = result.R.allFinite() && result.covariance.allFinite();
  return result;
}

/// SplitMix64: a small generator whose numbers are the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::size_t Below(std::size_t n) {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<std::size_t>((z ^ (z >> 31)) % n);
  }

 private:
  std::uint64_t state_;
};

constexpr std::array<std::array<double, 3>, 5> kDirections = {
    {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0.7, 0, 0.7}, {-0.7, 0, 0.7}}};

}  // namespace

/// With the correction for small samples of
/// P. Rousseeuw and A. Leroy, "Robust Regression and Outlier Detection" (1987), for 5 parameters.
double RobustSigma(std::vector<double> errors) {
  const auto n = static_cast<double>(errors.size());
  return 1.4826 * (1.0 + 5.0 / std::max(n - 5.0, 1.0)) * QuantileOf(&errors, 0.5);
}

double EpipolarError(const Matrix3& R, const Vector3& t, const TwoViewMatch& m, double sigma_x,
                     double sigma_y) {
  return Epipolar({R, t}, m, {sigma_x, sigma_y}).error;
}

std::vector<TwoViewMatch> SomeOf(const std::vector<TwoViewMatch>& matches, std::size_t most) {
  if (matches.size() <= most) return matches;
  std::vector<TwoViewMatch> some;
  for (std::size_t k = 0; k < most; ++k)
    some.push_back(matches[k * matches.size() / most]);
  return some;
}

TwoViewMotion EstimateTwoView(const std::vector<TwoViewMatch>& matches, double sigma_x,
                              double sigma_y, std::uint64_t seed) {
  TwoViewMotion result;
  const std::size_t n = matches.size();
  if (n < 12) return result;
  const Noise noise{sigma_x, sigma_y};
  // Candidates come from some of the matches, and are compared on all.
  const std::vector<TwoViewMatch> some = SomeOf(matches, 60);
  const Matrix3 start = RotationAlone(some);
  Best best(matches, noise);
  for (const auto& direction : kDirections) {
    Motion motion{start, Vector3(direction.data()).normalized()};
    Fit(some, noise, 2.0, 12, &motion);
    best.Try(motion);
  }
  Random random(seed);
  std::vector<TwoViewMatch> sample(5);
  for (int k = 0; k < 60 && best.sigma() > 1.3; ++k) {
    for (TwoViewMatch& m : sample)
      m = matches[random.Below(n)];
    Motion motion{start,
                  Vector3(kDirections[random.Below(kDirections.size())].data()).normalized()};
    Fit(sample, noise, 0.0, 6, &motion);
    best.Try(motion);
  }
  if (!std::isfinite(best.sigma())) return result;
  return Refine(matches, noise, best.motion(), best.sigma());
}

EpipolarSum SumEpipolar(const std::vector<TwoViewMatch>& matches, double sigma_x, double sigma_y,
                        const Matrix3& R, int iterations, Vector3* t) {
  const Noise noise{sigma_x, sigma_y};
  constexpr double kWidth2 = 9.0;  // of Cauchy's loss, in sigmas squared
  EpipolarSum sum;
  for (int k = 0;; ++k) {
    const Motion motion{R, *t};
    const Matrix<3, 2> b = TangentsAt(*t);
    Matrix5 H = Matrix5::Zero();
    Vector5 g = Vector5::Zero();
    sum.cost = 0.0;
    for (const TwoViewMatch& m : matches) {
      const Epipolar at(motion, m, noise);
      Vector3 by_rotation, by_translation;
      at.Derivatives(motion, &by_rotation, &by_translation);
      Vector5 J;
      J.head<3>() = by_rotation;
      J.tail<2>() = b.transpose() * by_translation;
      const double s = at.error * at.error / kWidth2;
      const double w = 1.0 / (1.0 + s);
      H += w * J * J.transpose();
      g += w * at.error * J;
      sum.cost += kWidth2 * std::log1p(s);
    }
    Matrix2 C = H.bottomRightCorner<2, 2>();
    C.diagonal().array() += 1.0;  // a direction is known to a radian
    const Matrix2 inverse = C.inverse();
    if (k == iterations) {
      const Matrix<3, 2> BC = H.topRightCorner<3, 2>() * inverse;
      sum.information = H.topLeftCorner<3, 3>() - BC * H.bottomLeftCorner<2, 3>();
      sum.gradient = g.head<3>() - BC * g.tail<2>();
      return sum;
    }
    Vector2 d = -(inverse * g.tail<2>());
    if (!d.allFinite()) d.setZero();
    if (d.norm() > 0.5) d *= 0.5 / d.norm();
    *t = (*t + b * d).normalized();
  }
}

TwoViewMotion RefineTwoView(const std::vector<TwoViewMatch>& matches, double sigma_x,
                            double sigma_y, const Matrix3& R, const Vector3& t) {
  if (matches.size() < 12) return {};
  const Noise noise{sigma_x, sigma_y};
  Motion motion{R, t};
  for (const double width : {8.0, 4.0, 2.0}) {
    const double sigma = RobustSigma(ErrorsOf(matches, motion, noise));
    Fit(matches, noise, std::max(width * sigma, 1e-3), 6, &motion);
  }
  return Refine(matches, noise, motion, RobustSigma(ErrorsOf(matches, motion, noise)));
}

}  // namespace glissade::internal
