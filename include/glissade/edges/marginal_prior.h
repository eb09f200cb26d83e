// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>

#include "glissade/edges/dynamic.h"

namespace glissade {

/// What is left of marginalized states: a quadratic on any number of vertices of any types,
///     r(x) = r0 + J (x boxminus x0).
/// The residual is exact; a solve takes J as it is for its derivative (first-estimate Jacobians:
/// the marginalized information was linearized at x0 and has no other derivative), so H = J'J is
/// constant and computed once. At x = x0 the two agree. Copies share their numbers.
///
/// Source: G. Huang, A. Mourikis, S. Roumeliotis, "A First-Estimates Jacobian EKF for Improving
/// SLAM Consistency" (ISER 2008); S. Leutenegger et al., "Keyframe-Based Visual-Inertial Odometry
/// Using Nonlinear Optimization" (IJRR 2015), Sec. 4.3.
class EdgeMarginalPrior final : public DynamicEdge {
 public:
  // No move: what was moved from would be a prior without numbers.
  EdgeMarginalPrior(const EdgeMarginalPrior&) = default;
  EdgeMarginalPrior& operator=(const EdgeMarginalPrior&) = default;

  /// vertices: the types, in the order in which the edge will be given its vertices. x0: their
  /// ambient states, one after the other. r0: rows. J: rows x D, row-major, with D the sum of the
  /// tangent dimensions. Refused: sizes that do not match and states that are none, such as a zero
  /// quaternion (kInvalidArgument), numbers that are not finite (kNotFinite), more columns than
  /// there is memory for their D x D Hessian (kOutOfMemory).
  static Result<std::unique_ptr<EdgeMarginalPrior>> Create(
      std::span<const VertexOps* const> vertices, std::span<const double> x0,
      std::span<const double> r0, std::span<const double> jacobian);

  /// The same with the storage of this edge, if no copy shares it: allocates nothing if the new
  /// numbers are not more. On failure the edge is as it was. Not while it is in a graph.
  Status Assign(std::span<const VertexOps* const> vertices, std::span<const double> x0,
                std::span<const double> r0, std::span<const double> jacobian);

  [[nodiscard]] std::span<const VertexOps* const> vertex_types() const;
  [[nodiscard]] std::span<const double> x0() const;
  [[nodiscard]] std::span<const double> r0() const;
  /// ResidualDim() x TangentDim(), row-major.
  [[nodiscard]] std::span<const double> jacobian() const;
  [[nodiscard]] int TangentDim() const;

  [[nodiscard]] Status CheckVertices(std::span<const VertexOps* const> vertices) const override;
  [[nodiscard]] int ResidualDim() const override;
  /// The exact derivative, J d(x boxminus x0)/dx.
  bool Evaluate(std::span<const VertexRef> vertices, double* residual,
                double* const* jacobians) const override;
  [[nodiscard]] const double* ConstantHessian() const override;
  /// gradient = J'r with the constant J.
  bool LinearizeQuadratic(std::span<const VertexRef> vertices, double* gradient,
                          double* squared_norm) const override;
  [[nodiscard]] const double* LinearizationPoint() const override;
  [[nodiscard]] std::unique_ptr<DynamicEdge> Clone() const override;

 private:
  struct Data;
  explicit EdgeMarginalPrior(std::shared_ptr<Data> data) : data_(std::move(data)) {}
  static Status Check(std::span<const VertexOps* const> vertices, std::span<const double> x0,
                      std::span<const double> r0, std::span<const double> jacobian);

  std::shared_ptr<Data> data_;  // shared by copies; not written while it is
};

namespace internal {
/// d((x boxplus d) boxminus x0)/dd at d = 0, row-major, tangent_dim square. Of types that do not
/// offer it: differences of fourth order, good to about 1e-12.
void MinusJacobian(const VertexOps& ops, const double* x, const double* x0, double* D);
}  // namespace internal

}  // namespace glissade
