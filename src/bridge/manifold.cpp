// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/bridge/manifold.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "bridge/vertex_manifold.h"
#include "glissade/vertices/pose.h"

namespace glissade::bridge {

namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

bool IsPose(const VertexOps& ops) {
  return ops.type == &kTypeInfo<VertexPose>;
}

void Identity(int n, double* jacobian) {
  std::fill_n(jacobian, n * n, 0.0);
  for (int i = 0; i < n; ++i)
    jacobian[i * n + i] = 1.0;
}

/// d(q Exp(d))/dd, 4 x 3: half the orthonormal basis of the tangent space of the unit sphere at q.
Eigen::Matrix<double, 4, 3> QuaternionPlusJacobian(const double* q) {
  const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double x = 0.5 * q[0] / n, y = 0.5 * q[1] / n, z = 0.5 * q[2] / n, w = 0.5 * q[3] / n;
  Eigen::Matrix<double, 4, 3> J;
  J << w, -z, y,  //
      z, w, -x,   //
      -y, x, w,   //
      -x, -y, -z;
  return J;
}

/// Column k of d(x boxplus d)/dd: central differences with halved steps, extrapolated to step zero
/// (C. Ridders, "Accurate computation of F'(x) and F'(x)F''(x)", 1982); row by row the entry of the
/// table with the smallest estimated error.
void DifferentiatePlus(const VertexOps& ops, const double* x, int k, double* jacobian) {
  constexpr int kLevels = 12;
  const int n = ops.ambient_dim;
  std::vector<double> delta(static_cast<std::size_t>(ops.tangent_dim), 0.0);
  Eigen::VectorXd plus(n), minus(n);
  Eigen::MatrixXd table(n, kLevels), previous(n, kLevels);
  std::vector<double> best_error(static_cast<std::size_t>(n),
                                 std::numeric_limits<double>::infinity());
  double step = 0.05;
  for (int level = 0; level < kLevels; ++level, step *= 0.5) {
    delta[static_cast<std::size_t>(k)] = step;
    ops.plus(x, delta.data(), plus.data());
    delta[static_cast<std::size_t>(k)] = -step;
    ops.plus(x, delta.data(), minus.data());
    table.col(0) = (plus - minus) / (2.0 * step);
    double power = 1.0;
    for (int j = 1; j <= level; ++j) {
      power *= 4.0;
      table.col(j) = table.col(j - 1) + (table.col(j - 1) - previous.col(j - 1)) / (power - 1.0);
      for (int row = 0; row < n; ++row) {
        const double rounding = 2e-16 * (std::abs(plus[row]) + std::abs(minus[row])) / step;
        const double error = std::max({rounding, std::abs(table(row, j) - table(row, j - 1)),
                                       std::abs(table(row, j) - previous(row, j - 1))});
        double& best = best_error[static_cast<std::size_t>(row)];
        if (error < best) {
          best = error;
          jacobian[row * ops.tangent_dim + k] = table(row, j);
        }
      }
    }
    std::swap(table, previous);
  }
}

}  // namespace

void PlusJacobian(const VertexOps& ops, const double* x, double* jacobian) {
  if (ops.additive) {
    Identity(ops.tangent_dim, jacobian);
  } else if (IsPose(ops)) {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> J(jacobian);
    J.setZero();
    J.topLeftCorner<3, 3>().setIdentity();
    J.bottomRightCorner<4, 3>() = QuaternionPlusJacobian(x + 3);
  } else {
    std::fill_n(jacobian, ops.ambient_dim * ops.tangent_dim, 0.0);
    for (int k = 0; k < ops.tangent_dim; ++k)
      DifferentiatePlus(ops, x, k, jacobian);
  }
}

void MinusJacobian(const VertexOps& ops, const double* x, double* jacobian) {
  if (ops.additive) {
    Identity(ops.tangent_dim, jacobian);
  } else if (IsPose(ops)) {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> J(jacobian);
    J.setZero();
    J.topLeftCorner<3, 3>().setIdentity();
    J.bottomRightCorner<3, 4>() = 4.0 * QuaternionPlusJacobian(x + 3).transpose();
  } else {
    RowMajorMatrix plus(ops.ambient_dim, ops.tangent_dim);
    PlusJacobian(ops, x, plus.data());
    Eigen::Map<RowMajorMatrix>(jacobian, ops.tangent_dim, ops.ambient_dim) =
        (plus.transpose() * plus).ldlt().solve(plus.transpose());
  }
}

std::unique_ptr<ceres::Manifold> MakeManifold(const VertexOps& ops) {
  if (ops.additive) return nullptr;
  return std::make_unique<VertexManifold>(ops);
}

// ---- VertexManifold
// ------------------------------------------------------------------------------

bool VertexManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  ops_.plus(x, delta, x_plus_delta);
  return true;
}

bool VertexManifold::PlusJacobian(const double* x, double* jacobian) const {
  bridge::PlusJacobian(ops_, x, jacobian);
  return true;
}

bool VertexManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  ops_.minus(y, x, y_minus_x);
  return true;
}

bool VertexManifold::MinusJacobian(const double* x, double* jacobian) const {
  bridge::MinusJacobian(ops_, x, jacobian);
  return true;
}

// ---- RotationOnlyManifold
// ------------------------------------------------------------------------

bool RotationOnlyManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const double full[6] = {0.0, 0.0, 0.0, delta[0], delta[1], delta[2]};
  kVertexOps<VertexPose>.plus(x, full, x_plus_delta);
  return true;
}

bool RotationOnlyManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 3, Eigen::RowMajor>> J(jacobian);
  J.setZero();
  J.bottomRows<4>() = QuaternionPlusJacobian(x + 3);
  return true;
}

bool RotationOnlyManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  double full[6];
  kVertexOps<VertexPose>.minus(y, x, full);
  std::copy_n(full + 3, 3, y_minus_x);
  return true;
}

bool RotationOnlyManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> J(jacobian);
  J.setZero();
  J.rightCols<4>() = 4.0 * QuaternionPlusJacobian(x + 3).transpose();
  return true;
}

}  // namespace glissade::bridge
