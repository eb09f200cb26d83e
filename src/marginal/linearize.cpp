// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <string>

#include "glissade/base/index.h"
#include "glissade/base/validate.h"
#include "glissade/graph/pools.h"
#include "glissade/graph/robust.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/pose.h"
#include "marginal/system.h"

namespace glissade::internal {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Kind = MarginalVariable::Kind;

using internal::Index;

/// J and r as they enter the normal equations: robust.h at sizes known at run time.
void Robustify(const Loss& loss, int rows, int dims, double* r, double* J, int stride) {
  if (loss.trivial()) return;
  double s = 0.0;
  for (int k = 0; k < rows; ++k)
    s += r[k] * r[k];
  const RobustScale scale(loss, s);
  for (int c = 0; c < dims; ++c) {
    double projection = 0.0;
    if (scale.alpha_over_s != 0.0) {
      for (int k = 0; k < rows; ++k)
        projection += r[k] * J[k * stride + c];
    }
    for (int k = 0; k < rows; ++k) {
      J[k * stride + c] =
          scale.jacobian_scale * (J[k * stride + c] - scale.alpha_over_s * projection * r[k]);
    }
  }
  for (int k = 0; k < rows; ++k)
    r[k] *= scale.residual_scale;
}

/// Whether the edge's Jacobian with respect to vertex i was taken at x_lin.
bool TakenAtFirstEstimate(const EdgePoolBase& pool, int i, const VertexOps& ops) {
  if (ops.first_estimate_size == 0) return false;
  if (pool.traits().first_estimate_rule != FirstEstimateRule::kWhole) return i < 2;
  return i >= kMaxTypedArity || (pool.traits().no_first_estimate >> i & 1u) == 0;
}

}  // namespace

Status MarginalSystem::Linearize(std::span<const MarginalEdge> edges, RowPanel* panel) {
  LayOutPanel(edges, panel);
  int row = 0;
  for (const MarginalEdge& edge : edges) {
    if (AsPrior(edge) != nullptr) {
      LinearizePrior(edge, panel->Row(row), *panel);
    } else if (!LinearizeEdge(edge, panel->Row(row), *panel) ||
               !AllFinite(panel->Row(row), edge.rows * panel->stride)) {
      const AnyEdge handle = edge.pool->HandleAt(edge.edge);
      return {StatusCode::kEvaluationFailed,
              "Marginalize: edge " + ToString(handle) + " has no finite residual or Jacobian",
              handle};
    }
    row += edge.rows;
  }
  return {};
}

void MarginalSystem::LayOutPanel(std::span<const MarginalEdge> edges, RowPanel* panel) {
  panel->parts.clear();
  panel->rows = 0;
  panel->landmark_dim = 0;
  if (panel_column_.size() < variables_.size()) panel_column_.resize(variables_.size());
  const std::int32_t landmark =
      edges.empty() || edges.front().landmark < 0 ? -1 : landmarks_[Index(edges.front().landmark)];
  int columns = 0;
  for (const MarginalEdge& edge : edges) {
    panel->rows += edge.rows;
    for (int i = 0; i < edge.arity; ++i)
      panel_column_[Index(of_edge_[Index(edge.begin + i)])] = -1;
  }
  for (const MarginalEdge& edge : edges) {
    for (int i = 0; i < edge.arity; ++i) {
      const std::int32_t k = of_edge_[Index(edge.begin + i)];
      if (k == landmark || variable(k).kind == Kind::kHeld || panel_column_[Index(k)] >= 0)
        continue;
      panel_column_[Index(k)] = 0;
      panel->parts.push_back({k, 0});
    }
  }
  if (landmark >= 0) {
    panel_column_[Index(landmark)] = 0;
    columns = panel->landmark_dim = variable(landmark).dim;
  }
  std::sort(panel->parts.begin(), panel->parts.end(),
            [&](const RowPanel::Part& a, const RowPanel::Part& b) {
              return variable(a.variable).column < variable(b.variable).column;
            });
  for (RowPanel::Part& part : panel->parts) {
    part.column = panel_column_[Index(part.variable)] = columns;
    columns += variable(part.variable).dim;
  }
  panel->columns = columns + 1;
  panel->stride = (panel->columns + 7) / 8 * 8;
  // An older prior may have as many rows as columns, or less: room for the most.
  panel->data.reserve(Index(std::max(panel->rows, panel->columns)) * Index(panel->stride));
  panel->data.assign(Index(panel->rows) * Index(panel->stride), 0.0);
}

void MarginalSystem::AddBlock(const MarginalVariable& variable, const double* J, int rows,
                              int stride_of_J, const RowPanel& panel, double* out) {
  const auto k = static_cast<std::size_t>(&variable - variables_.data());
  const int dim = variable.pool->ops().tangent_dim;
  if (variable.kind == Kind::kHeld) return;
  double* const block = out + panel_column_[k];
  if (variable.tangent < 0) {
    for (int row = 0; row < rows; ++row) {
      for (int c = 0; c < dim; ++c)
        block[row * panel.stride + c] += J[row * stride_of_J + c];
    }
    return;
  }
  FreeTangent tangent = graph_->free_tangents()[Index(variable.tangent)];
  tangent.UpdateBasis(variable.x);
  for (int row = 0; row < rows; ++row) {
    for (int c = 0; c < variable.dim; ++c) {
      for (int t = 0; t < dim; ++t) {
        block[row * panel.stride + c] +=
            J[row * stride_of_J + t] * tangent.basis[t * tangent.free_dim + c];
      }
    }
  }
}

// r0 = r - J (x boxminus x0).
void MarginalSystem::SubtractDelta(const MarginalVariable& variable, int rows, const double* J,
                                   const RowPanel& panel, double* out) const {
  const int dim = variable.pool->ops().tangent_dim;
  const double* delta = deltas_.data() + variable.delta;
  for (int row = 0; row < rows; ++row) {
    double sum = 0.0;
    for (int c = 0; c < dim; ++c)
      sum += J[row * dim + c] * delta[c];
    out[row * panel.stride + panel.columns - 1] -= sum;
  }
}

void MarginalSystem::MoveToOrigin(const MarginalVariable& variable, int rows, double* J) {
  const VertexOps& ops = variable.pool->ops();
  if (!variable.moved || ops.additive) return;
  if (ops.type == &kTypeInfo<VertexPose>) {
    const double* delta = deltas_.data() + variable.delta + 3;
    const Matrix3 D = so3::Jr(Vector3(delta[0], delta[1], delta[2]));
    for (int row = 0; row < rows; ++row) {
      Eigen::Map<Eigen::RowVector3d> theta(J + 6 * row + 3);
      theta = (theta * D).eval();
    }
    return;
  }
  const int n = ops.tangent_dim;
  RowMajor D(n, n);
  MinusJacobian(ops, variable.x, variable.x0, D.data());
  Eigen::Map<RowMajor> block(J, rows, n);
  block = (block * D.inverse()).eval();
}

bool MarginalSystem::LinearizeEdge(const MarginalEdge& edge, double* rows, const RowPanel& panel) {
  const auto arity = Index(edge.arity);
  states_.resize(arity);
  points_.resize(arity);
  blocks_.resize(arity);
  int dims = 0;
  for (int i = 0; i < edge.arity; ++i)
    dims += VertexOf(edge, i).pool->ops().tangent_dim;
  residual_.resize(Index(edge.rows));
  jacobian_.resize(Index(edge.rows) * Index(dims));
  double* block = jacobian_.data();
  for (int i = 0; i < edge.arity; ++i) {
    const MarginalVariable& v = VertexOf(edge, i);
    states_[Index(i)] = v.x;
    points_[Index(i)] = v.moved ? v.x0 : nullptr;
    blocks_[Index(i)] = block;
    block += edge.rows * v.pool->ops().tangent_dim;
  }
  if (!edge.pool->EvaluateAt(edge.edge, states_.data(), points_.data(), residual_.data(),
                             blocks_.data())) {
    return false;
  }
  edge.pool->Whiten(edge.edge, residual_.data(), blocks_.data());
  const Loss& loss = edge.pool->loss(edge.edge);
  for (int i = 0; i < edge.arity && !loss.trivial(); ++i) {
    const int dim = VertexOf(edge, i).pool->ops().tangent_dim;
    product_.assign(residual_.begin(), residual_.end());
    Robustify(loss, edge.rows, dim, product_.data(), blocks_[Index(i)], dim);
    if (i + 1 == edge.arity) residual_.swap(product_);
  }
  for (int row = 0; row < edge.rows; ++row)
    rows[row * panel.stride + panel.columns - 1] += residual_[Index(row)];
  for (int i = 0; i < edge.arity; ++i) {
    const MarginalVariable& v = VertexOf(edge, i);
    const VertexOps& ops = v.pool->ops();
    if (!TakenAtFirstEstimate(*edge.pool, i, ops)) {
      MoveToOrigin(v, edge.rows, blocks_[Index(i)]);
    }
    if (v.moved) SubtractDelta(v, edge.rows, blocks_[Index(i)], panel, rows);
    AddBlock(v, blocks_[Index(i)], edge.rows, ops.tangent_dim, panel, rows);
  }
  return true;
}

void MarginalSystem::LinearizePrior(const MarginalEdge& edge, double* rows, const RowPanel& panel) {
  const EdgeMarginalPrior& prior = *AsPrior(edge);
  const int stride_of_J = prior.TangentDim();
  const double* J = prior.jacobian().data();
  const double* origin = prior.x0().data();
  const int residual = panel.columns - 1;
  for (int row = 0; row < edge.rows; ++row)
    rows[row * panel.stride + residual] = prior.r0()[Index(row)];
  for (int i = 0; i < edge.arity; ++i) {
    const MarginalVariable& v = VertexOf(edge, i);
    const VertexOps& ops = v.pool->ops();
    const int n = ops.tangent_dim;
    if (std::equal(origin, origin + ops.ambient_dim, v.x0)) {
      AddBlock(v, J, edge.rows, stride_of_J, panel, rows);
    } else {
      // To the new origin: r0 += J (x0 boxminus origin), J <- J d((x0 + d) boxminus origin)/dd.
      product_.reserve(Index(std::max(edge.rows, stride_of_J)) * Index(n));
      product_.resize(Index(edge.rows) * Index(n));
      origin_.resize(Index(n) + Index(n) * Index(n));
      double* const D = origin_.data() + n;
      ops.minus(v.x0, origin, origin_.data());
      MinusJacobian(ops, v.x0, origin, D);
      for (int row = 0; row < edge.rows; ++row) {
        const double* from = J + row * stride_of_J;
        for (int c = 0; c < n; ++c) {
          rows[row * panel.stride + residual] += from[c] * origin_[Index(c)];
          double sum = 0.0;
          for (int t = 0; t < n; ++t)
            sum += from[t] * D[t * n + c];
          product_[Index(row * n + c)] = sum;
        }
      }
      AddBlock(v, product_.data(), edge.rows, n, panel, rows);
    }
    J += n;
    origin += ops.ambient_dim;
  }
}

}  // namespace glissade::internal
