// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <cmath>

namespace glissade::bench {

/// As somebody who knows Ceres writes it: EdgeBal's derivatives, row-major as Ceres has them.
class BalCost final : public ceres::SizedCostFunction<2, 9, 3> {
 public:
  BalCost(double u, double v) : u_(u), v_(v) {}

  bool Evaluate(double const* const* x, double* r, double** J) const override {
    using Eigen::Map;
    using Eigen::Matrix;
    using Eigen::Vector3d;
    const double* c = x[0];
    const Map<const Vector3d> w(c), X(x[1]);
    const double angle2 = w.squaredNorm();
    const double angle = std::sqrt(angle2);
    // Exp(w) and its left Jacobian.
    const double a = angle2 > 1e-16 ? std::sin(angle) / angle : 1.0;
    const double b = angle2 > 1e-16 ? (1.0 - std::cos(angle)) / angle2 : 0.5;
    const double d = angle2 > 1e-16 ? (1.0 - a) / angle2 : 1.0 / 6.0;
    const Eigen::Matrix3d hat = Skew(w), hat2 = hat * hat;
    const Eigen::Matrix3d R = Eigen::Matrix3d::Identity() + a * hat + b * hat2;
    const Vector3d rotated = R * X;
    const Vector3d P = rotated + Map<const Vector3d>(c + 3);
    const double inverse = -1.0 / P[2];
    const double p[2] = {inverse * P[0], inverse * P[1]};
    const double n = p[0] * p[0] + p[1] * p[1];
    const double f = c[6], k1 = c[7], k2 = c[8];
    const double distortion = 1.0 + n * (k1 + k2 * n);
    r[0] = f * distortion * p[0] - u_;
    r[1] = f * distortion * p[1] - v_;
    if (J == nullptr) return true;
    const double slope = 2.0 * (k1 + 2.0 * k2 * n);
    const double off = f * slope * p[0] * p[1];
    const double dxx = f * (distortion + slope * p[0] * p[0]);
    const double dyy = f * (distortion + slope * p[1] * p[1]);
    Matrix<double, 2, 3> d_P;
    d_P << dxx, off, dxx * p[0] + off * p[1], off, dyy, off * p[0] + dyy * p[1];
    d_P *= inverse;
    if (J[0] != nullptr) {
      Map<Matrix<double, 2, 9, Eigen::RowMajor>> d_c(J[0]);
      const Eigen::Matrix3d Jl = Eigen::Matrix3d::Identity() + b * hat + d * hat2;
      d_c.leftCols<3>().noalias() = -(d_P * Skew(rotated)) * Jl;
      d_c.middleCols<3>(3) = d_P;
      for (int k = 0; k < 2; ++k) {
        d_c(k, 6) = distortion * p[k];
        d_c(k, 7) = f * n * p[k];
        d_c(k, 8) = f * n * n * p[k];
      }
    }
    if (J[1] != nullptr) Map<Matrix<double, 2, 3, Eigen::RowMajor>>(J[1]).noalias() = d_P * R;
    return true;
  }

 private:
  static Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
    return m;
  }
  double u_, v_;
};

}  // namespace glissade::bench
