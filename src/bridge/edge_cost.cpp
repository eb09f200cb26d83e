// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/edge_cost.h"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <utility>

#include "bridge/scratch.h"
#include "glissade/bridge/manifold.h"
#include "glissade/graph/pools.h"
#include "glissade/vertices/pose.h"

namespace glissade::bridge {

namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstMap = Eigen::Map<const RowMajorMatrix>;

}  // namespace

int ExportedVertex::free_dim() const {
  switch (fix) {
    case Fix::kWhole:
      return 0;
    case Fix::kPosition:
    case Fix::kBiases:
      return 3;
    case Fix::kPositionAndYaw:
      return 2;
    case Fix::kNumbers:
      return ops->tangent_dim - std::popcount(held);
    case Fix::kFree:
    case Fix::kCoordinate:  // only while a solve is under way
      break;
  }
  return ops->tangent_dim;
}

FreeTangent ExportedVertex::ChartAt(const double* block) const {
  FreeTangent at = chart;
  at.dphi[0] = block[0];
  at.dphi[1] = block[1];
  return at;
}

void ExportedVertex::ToState(const double* block, double* state) const {
  if (!in_chart) {
    std::copy_n(block, ops->ambient_dim, state);
    return;
  }
  std::copy_n(chart_position, 3, state);
  const double no_step[2] = {0.0, 0.0};
  ChartAt(block).Plus(no_step, state);  // writes the rotation Exp(dphi) R0
}

void ExportedVertex::ToBlockJacobian(int rows, const double* block, const double* tangent_jacobian,
                                     double* block_jacobian) const {
  const int tangent_dim = ops->tangent_dim;
  const ConstMap J(tangent_jacobian, rows, tangent_dim);
  Eigen::Map<RowMajorMatrix> out(block_jacobian, rows, block_size());
  if (in_chart) {
    double state[7];
    ToState(block, state);
    FreeTangent at = ChartAt(block);
    at.UpdateBasis(state);
    out.noalias() = J.lazyProduct(ConstMap(at.basis, tangent_dim, at.free_dim));
    return;
  }
  const Scratch<double, 128> minus(static_cast<std::size_t>(tangent_dim * ops->ambient_dim));
  MinusJacobian(*ops, block, minus.data());
  out.noalias() = J.lazyProduct(ConstMap(minus.data(), tangent_dim, ops->ambient_dim));
}

EdgeCost::EdgeCost(const EdgePoolBase& pool, int edge, std::vector<const ExportedVertex*> vertices)
    : pool_(pool), edge_(edge), vertices_(std::move(vertices)) {
  set_num_residuals(pool.residual_dim(edge));
  for (const ExportedVertex* vertex : vertices_)
    mutable_parameter_block_sizes()->push_back(vertex->block_size());
}

bool EdgeCost::Evaluate(const double* const* parameters, double* residuals,
                        double** jacobians) const {
  const std::size_t n = vertices_.size();
  const auto rows = static_cast<std::size_t>(num_residuals());
  std::size_t num_tangent = 0;
  for (const ExportedVertex* vertex : vertices_)
    num_tangent += static_cast<std::size_t>(vertex->ops->tangent_dim);

  const Scratch<const double*, 8> states(n);
  const Scratch<double, 4 * 7> poses_in_chart(7 * n);
  for (std::size_t i = 0; i < n; ++i) {
    states.data()[i] = parameters[i];
    if (!vertices_[i]->in_chart) continue;
    double* pose = poses_in_chart.data() + 7 * i;
    vertices_[i]->ToState(parameters[i], pose);
    states.data()[i] = pose;
  }

  // Additive vertices write straight into Ceres's block, the others into a tangent Jacobian first.
  const Scratch<double*, 8> blocks(n);
  const Scratch<double, 128> tangent(jacobians != nullptr ? rows * num_tangent : 0);
  double* next = tangent.data();
  for (std::size_t i = 0; i < n; ++i) {
    const VertexOps& ops = *vertices_[i]->ops;
    const bool wanted = jacobians != nullptr && jacobians[i] != nullptr;
    blocks.data()[i] = wanted ? (ops.additive ? jacobians[i] : next) : nullptr;
    next += rows * static_cast<std::size_t>(ops.tangent_dim);
  }
  double* const* all = jacobians != nullptr ? blocks.data() : nullptr;
  if (!pool_.Evaluate(edge_, states.data(), residuals, all)) return false;
  pool_.Whiten(edge_, residuals, all);
  for (std::size_t i = 0; i < n; ++i) {
    const double* block = blocks.data()[i];
    if (block == nullptr || block == jacobians[i]) continue;
    vertices_[i]->ToBlockJacobian(num_residuals(), parameters[i], block, jacobians[i]);
  }
  return true;
}

}  // namespace glissade::bridge
