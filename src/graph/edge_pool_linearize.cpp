// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The loops of EdgePool over edges without a landmark, apart from its bookkeeping (those with one
// go in runs: EvaluateRun).

#include <algorithm>
#include <cmath>

#include "glissade/graph/edge_pool.h"
#include "glissade/graph/pools.h"
#include "glissade/graph/robust.h"
#include "graph/small_blocks.h"
#include "graph/wide_rows.h"

namespace glissade {

namespace {

/// Numbers from row to row of [J | r].
int WideStride(int dims) {
  return (dims + 1 + 7) / 8 * 8;
}

}  // namespace

int EdgePool::ScratchSize() const {
  const int stride = WideStride(dims_);
  const int values = rows_ * (1 + dims_);
  return values + (wide_ ? 2 * rows_ * stride + stride * stride : values);
}

// Scratch lies on the stack, sized by the edge's type: nothing is allocated, and edges of one pool
// can be taken side by side by several threads.

bool EdgePool::Linearize(const std::int32_t* words, int count, NormalEquationsSink* sink) const {
  auto* scratch = static_cast<double*>(
      __builtin_alloca(sizeof(double) * static_cast<std::size_t>(ScratchSize())));
  for (int k = 0; k < count; ++k, words += plan::NumWords(arity_)) {
    if (!LinearizeOne(words, scratch, sink)) {
      sink->failed_edge = words[plan::kEdge];
      return false;
    }
  }
  return true;
}

bool EdgePool::Cost(const std::int32_t* words, int count, NormalEquationsSink* sink) const {
  auto* scratch =
      static_cast<double*>(__builtin_alloca(sizeof(double) * internal::Index(2 * rows_)));
  const double* states[kMaxTypedArity];
  for (int k = 0; k < count; ++k, words += plan::NumWords(arity_)) {
    const int edge = words[plan::kEdge];
    States(words + plan::State(0), states);
    const double s = WhitenedSquaredNorm(edge, states, scratch);
    const Loss& rho = loss(edge);
    // NaN before a bounded loss makes a number of it.
    const double cost =
        std::isnan(s) || rho.trivial() ? 0.5 * s : internal::RobustScale(rho, s).cost;
    if (!std::isfinite(cost)) {
      sink->failed_edge = edge;
      return false;
    }
    sink->cost += cost;
  }
  return true;
}

double EdgePool::WhitenedSquaredNorm(int edge, const double* const* states, double* scratch) const {
  double* const r = scratch;
  if (!ops_->evaluate(Value(edge), states, r, nullptr)) return NAN;
  if (!HasIdentityInformation(edge)) {
    internal::MultiplyInPlace(rows_, 1, sqrt_information(edge), r, scratch + rows_);
  }
  return internal::SquaredNorm(rows_, r);
}

bool EdgePool::LinearizeOne(const std::int32_t* words, double* scratch,
                            NormalEquationsSink* sink) const {
  const int edge = words[plan::kEdge];
  double* const r = scratch;
  double* rest = scratch + rows_;
  const double* states[kMaxTypedArity];
  double* J[kMaxTypedArity];
  States(words + plan::State(0), states);
  for (int i = 0; i < arity_; rest += rows_ * dim_[i], ++i)
    J[i] = words[plan::Target(arity_, i)] != plan::kNone ? rest : nullptr;
  if (sink->first_estimates == FirstEstimates::kFull) {
    const double* points[kMaxTypedArity];
    for (int i = 0; i < arity_; ++i)
      points[i] = pools_[i]->first_estimates().At(words[plan::State(i)]);
    if (!EvaluateAt(edge, states, points, r, J)) return false;
  } else if (!ops_->evaluate(Value(edge), states, r, J)) {
    return false;
  }
  if (wide_) return AccumulateWide(words, r, J, rest, sink);

  if (!HasIdentityInformation(edge)) {
    const double* L = sqrt_information(edge);
    internal::MultiplyInPlace(rows_, 1, L, r, rest);
    for (int i = 0; i < arity_; ++i) {
      if (J[i] != nullptr) internal::MultiplyInPlace(rows_, dim_[i], L, J[i], rest);
    }
  }
  const double s = internal::SquaredNorm(rows_, r);
  if (std::isnan(s)) return false;  // a bounded loss would make a number of it
  const Loss& rho = loss(edge);
  if (rho.trivial()) {
    sink->cost += 0.5 * s;
  } else {
    const internal::RobustScale scale(rho, s);
    sink->cost += scale.cost;
    for (int i = 0; i < arity_; ++i) {
      if (J[i] != nullptr) internal::CorrectJacobian(scale, rows_, dim_[i], r, J[i]);
    }
    for (int k = 0; k < rows_; ++k)
      r[k] *= scale.residual_scale;
  }
  double poison = 0.0 * sink->cost;
  for (int i = 0; i < arity_; ++i) {
    if (J[i] != nullptr) poison += internal::Poison(rows_ * dim_[i], J[i]);
  }
  if (poison != 0.0) return false;
  Accumulate(words, r, J, sink);
  return true;
}

void EdgePool::Accumulate(const std::int32_t* words, const double* r,
                          const double* const* jacobians, NormalEquationsSink* sink) const {
  for (int i = 0; i < arity_; ++i) {
    const double* J_i = jacobians[i];
    if (J_i == nullptr) continue;
    internal::AddTransposedProduct(rows_, dim_[i], 1, -1.0, J_i, r,
                                   sink->b_p + words[plan::Target(arity_, i)]);
    for (int j = 0; j <= i; ++j) {
      const std::int32_t offset = words[plan::HBlock(arity_, plan::Pair(i, j))];
      if (offset == plan::kNone) continue;
      const double* J_j = jacobians[j];
      if (offset >= 0) {
        internal::AddTransposedProduct(rows_, dim_[i], dim_[j], 1.0, J_i, J_j, sink->h_pp + offset);
      } else {
        internal::AddTransposedProduct(rows_, dim_[j], dim_[i], 1.0, J_j, J_i,
                                       sink->h_pp + plan::Transposed(offset));
      }
    }
  }
}

bool EdgePool::AccumulateWide(const std::int32_t* words, const double* r,
                              const double* const* jacobians, double* scratch,
                              NormalEquationsSink* sink) const {
  // The rows [J | r] side by side; what a fixed vertex has no Jacobian for stays zero.
  const int stride = WideStride(dims_);
  double* const panel = scratch;
  double* const work = panel + rows_ * stride;
  double* const products = work + rows_ * stride;
  std::fill_n(panel, rows_ * stride, 0.0);
  int first[kMaxTypedArity];
  int column = 0;
  for (int i = 0; i < arity_; ++i) {
    first[i] = column;
    for (int k = 0; k < rows_ && jacobians[i] != nullptr; ++k)
      std::copy_n(jacobians[i] + k * dim_[i], dim_[i], panel + k * stride + column);
    column += dim_[i];
  }
  for (int k = 0; k < rows_; ++k)
    panel[k * stride + dims_] = r[k];

  const int edge = words[plan::kEdge];
  if (!internal::SquareRows(rows_, dims_, stride, whitening(edge), loss(edge), panel, work,
                            products, &sink->cost)) {
    return false;
  }
  for (int i = 0; i < arity_; ++i) {
    const std::int32_t target = words[plan::Target(arity_, i)];
    if (target == plan::kNone) continue;
    for (int k = 0; k < dim_[i]; ++k)
      sink->b_p[target + k] += products[dims_ + (first[i] + k) * stride];
    for (int j = 0; j <= i; ++j) {
      const std::int32_t offset = words[plan::HBlock(arity_, plan::Pair(i, j))];
      if (offset == plan::kNone) continue;
      const double* block = products + first[j] * stride + first[i];
      if (j == i) {
        internal::SubtractLower(dim_[i], stride, block, sink->h_pp + offset);
      } else if (offset >= 0) {
        internal::SubtractTransposed(dim_[i], dim_[j], stride, block, sink->h_pp + offset);
      } else {
        internal::SubtractBlock(dim_[j], dim_[i], stride, block,
                                sink->h_pp + plan::Transposed(offset));
      }
    }
  }
  return true;
}

}  // namespace glissade
