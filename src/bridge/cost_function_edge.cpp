// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/bridge/cost_function_edge.h"

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "bridge/scratch.h"
#include "glissade/bridge/manifold.h"

namespace glissade::bridge {

namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstMap = Eigen::Map<const RowMajorMatrix>;

}  // namespace

CostFunctionEdge::CostFunctionEdge(std::shared_ptr<const ceres::CostFunction> cost)
    : cost_(std::move(cost)) {}

Status CostFunctionEdge::CheckVertices(std::span<const VertexOps* const> vertices) const {
  if (cost_ == nullptr) return {StatusCode::kInvalidArgument, "ceres::CostFunction is null"};
  const std::vector<std::int32_t>& sizes = cost_->parameter_block_sizes();
  if (sizes.size() != vertices.size()) {
    return {StatusCode::kInvalidArgument, "the cost function has " + std::to_string(sizes.size()) +
                                              " parameter blocks, not " +
                                              std::to_string(vertices.size())};
  }
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (sizes[i] != vertices[i]->ambient_dim) {
      return {StatusCode::kInvalidArgument,
              "parameter block " + std::to_string(i) + " of the cost function has size " +
                  std::to_string(sizes[i]) + "; a " + std::string(vertices[i]->type->name) +
                  " has " + std::to_string(vertices[i]->ambient_dim)};
    }
  }
  return {};
}

int CostFunctionEdge::ResidualDim() const {
  return cost_ == nullptr ? 0 : cost_->num_residuals();
}

bool CostFunctionEdge::Evaluate(std::span<const VertexRef> vertices, double* residual,
                                double* const* jacobians) const {
  const std::size_t n = vertices.size();
  const int rows = cost_->num_residuals();
  const Scratch<const double*, 8> states(n);
  std::size_t num_ambient = 0;
  for (std::size_t i = 0; i < n; ++i) {
    states.data()[i] = vertices[i].data;
    num_ambient += static_cast<std::size_t>(vertices[i].ops->ambient_dim);
  }
  if (jacobians == nullptr) return cost_->Evaluate(states.data(), residual, nullptr);

  const Scratch<double*, 8> blocks(n);
  const Scratch<double, 128> ambient(static_cast<std::size_t>(rows) * num_ambient);
  double* next = ambient.data();
  for (std::size_t i = 0; i < n; ++i) {
    const VertexOps& ops = *vertices[i].ops;
    double* own = ops.additive ? jacobians[i] : next;
    blocks.data()[i] = jacobians[i] != nullptr ? own : nullptr;
    next += rows * ops.ambient_dim;
  }
  if (!cost_->Evaluate(states.data(), residual, blocks.data())) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const double* block = blocks.data()[i];
    if (block == nullptr || block == jacobians[i]) continue;
    const VertexOps& ops = *vertices[i].ops;
    const Scratch<double, 64> plus(static_cast<std::size_t>(ops.ambient_dim * ops.tangent_dim));
    PlusJacobian(ops, vertices[i].data, plus.data());
    Eigen::Map<RowMajorMatrix>(jacobians[i], rows, ops.tangent_dim).noalias() =
        ConstMap(block, rows, ops.ambient_dim)
            .lazyProduct(ConstMap(plus.data(), ops.ambient_dim, ops.tangent_dim));
  }
  return true;
}

std::unique_ptr<DynamicEdge> CostFunctionEdge::Clone() const {
  return std::make_unique<CostFunctionEdge>(*this);
}

}  // namespace glissade::bridge
