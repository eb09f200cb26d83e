// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <memory>
#include <span>

#include "glissade/edges/dynamic.h"

/// \file
/// Ceres cost and loss functions in a glissade graph, so that a program can move over edge by edge.
namespace glissade::bridge {

/// A ceres::CostFunction as an edge. Its parameter blocks are the ambient states of the edge's
/// vertices (VertexPose: px py pz qx qy qz qw); their sizes are checked when the edge is added.
/// Its ambient Jacobians become tangent ones by the vertex types' PlusJacobian (bridge/manifold.h).
/// The cost function must be safe to call from several threads; copies of the edge share it.
///
///     graph.AddEdge(std::make_unique<bridge::CostFunctionEdge>(
///                       std::make_shared<ceres::AutoDiffCostFunction<F, 2, 7, 3>>(new F(...))),
///                   std::vector<AnyVertex>{pose, point}, Huber{1.0});
class CostFunctionEdge final : public DynamicEdge {
 public:
  explicit CostFunctionEdge(std::shared_ptr<const ceres::CostFunction> cost);

  [[nodiscard]] Status CheckVertices(std::span<const VertexOps* const> vertices) const override;
  [[nodiscard]] int ResidualDim() const override;
  bool Evaluate(std::span<const VertexRef> vertices, double* residual,
                double* const* jacobians) const override;
  [[nodiscard]] std::unique_ptr<DynamicEdge> Clone() const override;

 private:
  std::shared_ptr<const ceres::CostFunction> cost_;
};

/// A ceres::LossFunction as a loss; not owned, it must outlive the graph.
struct CeresLoss {
  const ceres::LossFunction* function = nullptr;

  void Evaluate(double s, double rho[3]) const { function->Evaluate(s, rho); }
  [[nodiscard]] Status Validate() const {
    if (function != nullptr) return {};
    return {StatusCode::kInvalidArgument, "ceres::LossFunction is null"};
  }
};

}  // namespace glissade::bridge
