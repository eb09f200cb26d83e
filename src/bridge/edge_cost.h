// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <cstdint>
#include <vector>

#include "glissade/graph/edge_pool_base.h"
#include "glissade/graph/fix.h"
#include "glissade/graph/pools.h"
#include "glissade/losses/loss.h"

namespace glissade::bridge {

/// How a vertex appears in the ceres::Problem: see CeresProblem.
struct ExportedVertex {
  AnyVertex vertex;
  const VertexOps* ops = nullptr;
  Fix fix = Fix::kFree;
  bool eliminated = false;
  std::uint32_t held = 0;  ///< numbers of Fix::kNumbers, by bit
  /// Where it differs from its state: the chart of Fix::kPositionAndYaw and the held position.
  bool in_chart = false;
  FreeTangent chart;
  double chart_position[3] = {0.0, 0.0, 0.0};

  [[nodiscard]] int block_size() const { return in_chart ? 2 : ops->ambient_dim; }
  /// Degrees of freedom of the block.
  [[nodiscard]] int free_dim() const;
  /// The chart at the given block values: dphi and the basis of the free tangent.
  [[nodiscard]] FreeTangent ChartAt(const double* block) const;
  /// The ambient state that the block stands for.
  void ToState(const double* block, double* state) const;
  /// Block Jacobian (rows x block_size) of a Jacobian in the full tangent (rows x tangent_dim).
  void ToBlockJacobian(int rows, const double* block, const double* tangent_jacobian,
                       double* block_jacobian) const;
};

/// An edge of a graph as a ceres::CostFunction: the whitened residual. The pool and the vertices
/// are not owned.
class EdgeCost final : public ceres::CostFunction {
 public:
  EdgeCost(const EdgePoolBase& pool, int edge, std::vector<const ExportedVertex*> vertices);
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const EdgePoolBase& pool_;
  int edge_;
  std::vector<const ExportedVertex*> vertices_;
};

class LossOfEdge final : public ceres::LossFunction {
 public:
  explicit LossOfEdge(const Loss& loss) : loss_(loss) {}
  void Evaluate(double s, double rho[3]) const override { loss_.Evaluate(s, rho); }

 private:
  Loss loss_;
};

}  // namespace glissade::bridge
