// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "glissade/graph/graph.h"

/// \file
/// The normal equations the slow and obvious way: a dense Jacobian, edge by edge, with nothing of
/// the library's structure, elimination or accumulation.
namespace glissade::test {

struct DenseReference {
  double cost = 0.0;
  /// Whitened, with the robust correction applied.
  Eigen::MatrixXd J;
  Eigen::VectorXd r;

  /// Columns: the free tangents of `order`, one after the other.
  DenseReference(const Graph& graph, std::span<const AnyVertex> order);

  [[nodiscard]] Eigen::MatrixXd H() const { return J.transpose() * J; }
  /// -J'r.
  [[nodiscard]] Eigen::VectorXd b() const { return -(J.transpose() * r); }
};

/// Solution of min |J x + r|^2 + x' diag(damping) x by QR: no squared condition number.
Eigen::VectorXd DampedStep(const Eigen::MatrixXd& J, const Eigen::VectorXd& r,
                           const Eigen::VectorXd& damping);

/// lambda * clamp(diag(J'J)).
Eigen::VectorXd MarquardtDamping(const Eigen::MatrixXd& J, double lambda,
                                 double min_diagonal = 1e-6, double max_diagonal = 1e32);

/// Largest |A_ij - B_ij| / sqrt(B_ii B_jj): rows and columns in units of their own curvature.
double HessianError(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// |a - b| / |b|.
double RelativeError(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

}  // namespace glissade::test
