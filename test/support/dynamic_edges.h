// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "glissade/edges/dynamic.h"
#include "support/graph_random.h"

/// \file
/// Dynamic edges on any number of vertices of mixed types.
namespace glissade::test {

/// d(x boxplus d)/dd of every vertex type that random graphs hold, row-major ambient x tangent.
/// Apart from the bridge's, so that tests without Ceres have it and tests of the bridge do not
/// check it against itself.
void TangentBasis(const VertexRef& vertex, double* basis);

/// u = sum_i A_i x_i + c over ambient states, r_k = u_k + sin(u_k) / 2.
class SineEdge final : public DynamicEdge {
 public:
  /// Random coefficients; r(x) = 0 at the given states up to noise of 0.1.
  SineEdge(std::span<const VertexRef> vertices, int rows, GraphRandom* random);

  [[nodiscard]] Status CheckVertices(std::span<const VertexOps* const> vertices) const override;
  [[nodiscard]] int ResidualDim() const override { return static_cast<int>(c_.size()); }
  bool Evaluate(std::span<const VertexRef> vertices, double* residual,
                double* const* jacobians) const override;
  [[nodiscard]] std::unique_ptr<DynamicEdge> Clone() const override {
    return std::make_unique<SineEdge>(*this);
  }

 private:
  std::vector<Eigen::MatrixXd> A_;
  Eigen::VectorXd c_;
};

/// r = sum_i J_i y_i + c with y_i the part of the state that is additive: all of an additive
/// vertex, the position of a pose. So J'J is constant, exactly.
class LinearEdge final : public DynamicEdge {
 public:
  /// True for the vertex types it takes.
  static bool Takes(const VertexOps& ops);
  LinearEdge(std::span<const VertexRef> vertices, int rows, GraphRandom* random);

  [[nodiscard]] Status CheckVertices(std::span<const VertexOps* const> vertices) const override;
  [[nodiscard]] int ResidualDim() const override { return static_cast<int>(c_.size()); }
  bool Evaluate(std::span<const VertexRef> vertices, double* residual,
                double* const* jacobians) const override;
  [[nodiscard]] const double* ConstantHessian() const override { return H_.data(); }
  bool LinearizeQuadratic(std::span<const VertexRef> vertices, double* gradient,
                          double* squared_norm) const override;
  [[nodiscard]] std::unique_ptr<DynamicEdge> Clone() const override {
    return std::make_unique<LinearEdge>(*this);
  }

 private:
  [[nodiscard]] Eigen::VectorXd Residual(std::span<const VertexRef> vertices) const;

  std::vector<int> tangent_dims_;
  Eigen::MatrixXd J_;  ///< rows x sum of tangent dimensions
  Eigen::VectorXd c_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> H_;
};

}  // namespace glissade::test
