// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The hot part of DynamicEdgePool, apart from its bookkeeping.

#include "glissade/graph/dynamic_edge_pool.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/pools.h"
#include "glissade/graph/robust.h"

namespace glissade {

namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MatrixMap = Eigen::Map<RowMajorMatrix>;
using VectorMap = Eigen::Map<Eigen::VectorXd>;

/// Record of the edge's free landmark, null if it has none (no pointer may be made from kNone).
double* LandmarkRecord(const std::int32_t* words, const NormalEquationsSink& sink) {
  const std::int32_t landmark = words[plan::kLandmarkIndex];
  return landmark == plan::kNone ? nullptr : sink.landmarks + sink.records[landmark];
}

}  // namespace

void DynamicEdgePool::Add(const Entry& item, const std::int32_t* words, const double* H, int stride,
                          const double* gradient, NormalEquationsSink* sink) {
  const int arity = static_cast<int>(item.vertices.size());
  const auto dim = [&](int i) {
    return item.vertices[static_cast<std::size_t>(i)].pool->ops().tangent_dim;
  };
  double* const record = LandmarkRecord(words, *sink);
  int row = 0;
  for (int i = 0; i < arity; row += dim(i), ++i) {
    const std::int32_t target = words[plan::Target(arity, i)];
    if (target == plan::kNone) continue;
    const bool is_landmark = target == plan::kLandmark;
    double* b = is_landmark ? record + dim(i) * dim(i) : sink->b_p + target;
    for (int k = 0; k < dim(i); ++k)
      b[k] -= gradient[row + k];
    int col = 0;
    for (int j = 0; j < arity; col += dim(j), ++j) {
      // Destination of block (i, j): a landmark takes its row to W; other pairs once, j <= i.
      double* out = nullptr;
      bool transposed = false;
      if (is_landmark) {
        const std::int32_t w = words[plan::WBlock(arity, j)];
        out = j == i ? record : (w == plan::kNone ? nullptr : record + w);
        transposed = j != i;
      } else if (j <= i) {
        const std::int32_t offset = words[plan::HBlock(arity, plan::Pair(i, j))];
        if (offset != plan::kNone) {
          transposed = offset < 0;
          out = sink->h_pp + (transposed ? plan::Transposed(offset) : offset);
        }
      }
      if (out == nullptr) continue;
      const int rows = dim(i), cols = dim(j);
      for (int r = 0; r < rows; ++r) {
        const double* from = H + (row + r) * stride + col;
        if (transposed) {
          for (int c = 0; c < cols; ++c)
            out[c * rows + r] += from[c];
        } else {
          for (int c = 0; c < cols; ++c)
            out[r * cols + c] += from[c];
        }
      }
    }
  }
}

bool DynamicEdgePool::LinearizeConstant(const Entry& item, const std::int32_t* words,
                                        NormalEquationsSink* sink) const {
  double s = 0.0;
  if (!item.edge->LinearizeQuadratic(item.refs, item.gradient.data(), &s)) return false;
  double poison = 0.0 * s;
  for (const double g : item.gradient)
    poison += 0.0 * g;
  if (poison != 0.0) return false;
  sink->cost += 0.5 * s;
  Add(item, words, item.edge->ConstantHessian(), static_cast<int>(item.gradient.size()),
      item.gradient.data(), sink);
  return true;
}

bool DynamicEdgePool::LinearizeMoved(const Entry& item, const std::int32_t* words,
                                     NormalEquationsSink* sink) const {
  double s = 0.0;
  if (!item.edge->LinearizeQuadratic(item.refs, item.gradient.data(), &s)) return false;
  const std::size_t n = item.gradient.size();
  std::size_t largest = 0;
  for (const VertexRef& ref : item.refs)
    largest = std::max(largest, static_cast<std::size_t>(ref.ops->tangent_dim));
  item.jacobian.resize(n * n + largest * largest + largest);
  double* const H = item.jacobian.data();
  double* const D = H + n * n;
  double* const part = D + largest * largest;
  std::copy_n(item.edge->ConstantHessian(), n * n, H);
  const double* x0 = item.edge->LinearizationPoint();
  std::size_t first = 0;
  for (const VertexRef& ref : item.refs) {
    const auto dim = static_cast<std::size_t>(ref.ops->tangent_dim);
    if (!ref.ops->additive) {
      internal::MinusJacobian(*ref.ops, ref.data, x0, D);
      // x <- D'x for a part of the gradient, or of a row or column of H.
      const auto turn = [&](double* x, std::size_t stride) {
        for (std::size_t c = 0; c < dim; ++c) {
          part[c] = 0.0;
          for (std::size_t r = 0; r < dim; ++r)
            part[c] += D[r * dim + c] * x[r * stride];
        }
        for (std::size_t c = 0; c < dim; ++c)
          x[c * stride] = part[c];
      };
      turn(item.gradient.data() + first, 1);
      for (std::size_t k = 0; k < n; ++k)
        turn(H + first * n + k, n);
      for (std::size_t k = 0; k < n; ++k)
        turn(H + k * n + first, 1);
    }
    x0 += ref.ops->ambient_dim;
    first += dim;
  }
  double poison = 0.0 * s;
  for (const double g : item.gradient)
    poison += 0.0 * g;
  if (poison != 0.0) return false;
  sink->cost += 0.5 * s;
  Add(item, words, H, static_cast<int>(n), item.gradient.data(), sink);
  return true;
}

bool DynamicEdgePool::LinearizeGeneral(const Entry& item, const Loss& loss,
                                       const std::int32_t* words, NormalEquationsSink* sink) const {
  const int arity = static_cast<int>(item.vertices.size());
  const int rows = item.edge->ResidualDim();
  item.jacobian.reserve(item.residual.capacity() * item.gradient.size());
  item.jacobian.resize(item.residual.size() * item.gradient.size());
  // Jacobians of free vertices side by side: J_i at jacobian + rows * (columns before i).
  int dim = 0;
  for (int i = 0; i < arity; ++i) {
    const bool free = words[plan::Target(arity, i)] != plan::kNone;
    item.jacobian_of_vertex[static_cast<std::size_t>(i)] =
        free ? item.jacobian.data() + rows * dim : nullptr;
    dim += item.refs[static_cast<std::size_t>(i)].ops->tangent_dim;
  }
  const bool full = sink->first_estimates == FirstEstimates::kFull;
  const bool ok =
      item.edge->batch() != nullptr ? item.batch_has_value
      : full                        ? EvaluateFirstEstimates(item)
             : item.edge->Evaluate(item.refs, item.residual.data(), item.jacobian_of_vertex.data());
  if (!ok) return false;
  VectorMap r(item.residual.data(), rows);
  const double s = r.squaredNorm();
  const internal::RobustScale scale(loss, s);
  double poison = 0.0 * s;
  for (int i = 0; i < arity; ++i) {
    double* data = item.jacobian_of_vertex[static_cast<std::size_t>(i)];
    if (data == nullptr) continue;
    MatrixMap J(data, rows, item.refs[static_cast<std::size_t>(i)].ops->tangent_dim);
    poison += 0.0 * J.sum();
    if (loss.trivial()) continue;
    for (int c = 0; c < J.cols(); ++c) {
      double projection = 0.0;
      for (int k = 0; k < rows; ++k)
        projection += r[k] * J(k, c);
      for (int k = 0; k < rows; ++k) {
        J(k, c) = scale.jacobian_scale * (J(k, c) - scale.alpha_over_s * projection * r[k]);
      }
    }
  }
  if (poison != 0.0) return false;
  r *= scale.residual_scale;
  sink->cost += scale.cost;

  double* const record = LandmarkRecord(words, *sink);
  for (int i = 0; i < arity; ++i) {
    const std::int32_t target = words[plan::Target(arity, i)];
    if (target == plan::kNone) continue;
    const int d_i = item.refs[static_cast<std::size_t>(i)].ops->tangent_dim;
    const MatrixMap J_i(item.jacobian_of_vertex[static_cast<std::size_t>(i)], rows, d_i);
    const bool is_landmark = target == plan::kLandmark;
    VectorMap(is_landmark ? record + d_i * d_i : sink->b_p + target, d_i).noalias() -=
        J_i.transpose().lazyProduct(r);
    if (is_landmark) {
      MatrixMap(record, d_i, d_i).noalias() += J_i.transpose().lazyProduct(J_i);
    }
    for (int j = 0; j < arity; ++j) {
      if (words[plan::Target(arity, j)] == plan::kNone) continue;
      const int d_j = item.refs[static_cast<std::size_t>(j)].ops->tangent_dim;
      const MatrixMap J_j(item.jacobian_of_vertex[static_cast<std::size_t>(j)], rows, d_j);
      if (is_landmark) {
        const std::int32_t w = words[plan::WBlock(arity, j)];
        if (j == i || w == plan::kNone) continue;
        MatrixMap(record + w, d_j, d_i).noalias() += J_j.transpose().lazyProduct(J_i);
      } else if (j <= i) {
        const std::int32_t offset = words[plan::HBlock(arity, plan::Pair(i, j))];
        if (offset >= 0) {
          MatrixMap(sink->h_pp + offset, d_i, d_j).noalias() += J_i.transpose().lazyProduct(J_j);
        } else if (offset != plan::kNone) {
          MatrixMap(sink->h_pp + plan::Transposed(offset), d_j, d_i).noalias() +=
              J_j.transpose().lazyProduct(J_i);
        }
      }
    }
  }
  return true;
}

bool DynamicEdgePool::EvaluateFirstEstimates(const Entry& item) const {
  if (!item.edge->Evaluate(item.refs, item.residual.data(), nullptr)) return false;
  RefsToFirstEstimates(item);
  return item.edge->Evaluate(item.refs, item.points.data(), item.jacobian_of_vertex.data());
}

void DynamicEdgePool::RefsToFirstEstimates(const Entry& item) {
  std::size_t size = item.residual.size();
  for (const VertexRef& ref : item.refs)
    size += static_cast<std::size_t>(ref.ops->ambient_dim);
  item.points.resize(size);
  double* at = item.points.data() + item.residual.size();  // before it: a residual nobody wants
  for (std::size_t i = 0; i < item.refs.size(); ++i) {
    VertexRef& ref = item.refs[i];
    const VertexPoolBase* pool = item.vertices[i].pool;
    const double* point = pool->first_estimates().At(pool->slots().IndexOf(item.vertices[i].slot));
    if (point != nullptr && ref.ops->first_estimate_size > 0) {
      std::copy_n(ref.data, ref.ops->ambient_dim, at);
      std::copy_n(point, ref.ops->first_estimate_size, at);
      ref.data = at;
    }
    at += ref.ops->ambient_dim;
  }
}

bool DynamicEdgePool::Linearize(const std::int32_t* words, int count,
                                NormalEquationsSink* sink) const {
  for (int k = 0; k < count; ++k) {
    const int edge = words[plan::kEdge];
    const Entry& item = EntryAt(edge);
    SetRefs(item, words);
    // Where first estimates are not kept, a prior has its exact derivative: J is constant in the
    // tangent at its own x0, and what is added is in that at x.
    const bool constant = item.edge->ConstantHessian() != nullptr;
    const bool moved = constant && sink->first_estimates == FirstEstimates::kOff &&
                       item.edge->LinearizationPoint() != nullptr;
    const bool ok = !constant ? LinearizeGeneral(item, loss(edge), words, sink)
                    : moved   ? LinearizeMoved(item, words, sink)
                              : LinearizeConstant(item, words, sink);
    if (!ok) {
      sink->failed_edge = edge;
      return false;
    }
    words += plan::NumWords(static_cast<int>(item.vertices.size()));
  }
  return true;
}

bool DynamicEdgePool::Cost(const std::int32_t* words, int count, NormalEquationsSink* sink) const {
  for (int k = 0; k < count; ++k) {
    const int edge = words[plan::kEdge];
    const Entry& item = EntryAt(edge);
    SetRefs(item, words);
    double s = 0.0;
    bool ok;
    if (item.edge->ConstantHessian() != nullptr) {
      ok = item.edge->LinearizeQuadratic(item.refs, nullptr, &s);
    } else {
      ok = item.edge->batch() != nullptr
               ? item.batch_has_value
               : item.edge->Evaluate(item.refs, item.residual.data(), nullptr);
      for (const double value : item.residual)
        s += value * value;
    }
    const double cost = ok ? internal::RobustScale(loss(edge), s).cost : NAN;
    if (!std::isfinite(cost)) {
      sink->failed_edge = edge;
      return false;
    }
    sink->cost += cost;
    words += plan::NumWords(static_cast<int>(item.vertices.size()));
  }
  return true;
}

}  // namespace glissade
