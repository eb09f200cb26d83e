// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The hot loop of EdgePool, apart from its bookkeeping. Included by edge_pool.h only.

#include "glissade/graph/edge_pool.h"

namespace glissade {

namespace internal {

/// C (m x n, row-major) += A' B. On its own because GCC 12 breaks down over the type of C where it
/// is named inside nested generic lambdas.
template <int R, int M, int N>
void AddTransposedProduct(const Jacobian<R, M>& A, const Jacobian<R, N>& B, double* C) {
  Eigen::Map<Matrix<M, N>>(C).noalias() += A.transpose().lazyProduct(B);
}

}  // namespace internal

template <EdgeType E>
bool EdgePool<E>::LinearizeOne(const std::int32_t* words, NormalEquationsSink* sink) const {
  const int edge = words[plan::kEdge];
  Vector<kRows> r;
  Jacobians J;
  const bool ok = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return At(edge).Evaluate(
        std::get<I>(pools_)->At(words[plan::State(static_cast<int>(I))])..., r,
        (words[plan::Target(kArity, static_cast<int>(I))] != plan::kNone ? &std::get<I>(J)
                                                                         : nullptr)...);
  }
  (std::make_index_sequence<kArity>{});
  if (!ok) return false;

  const auto for_free = [&](auto&& f) {
    ForEachIndex<kArity>([&](auto i) {
      if (words[plan::Target(kArity, i)] != plan::kNone) f(std::get<i>(J));
    });
  };
  if (identity_[Index(edge)] == 0) {
    const SqrtInformation& L = sqrt_information_[Index(edge)];
    r = (L.lazyProduct(r)).eval();
    for_free([&](auto& block) { block = (L.lazyProduct(block)).eval(); });
  }
  const double s = r.squaredNorm();
  const Loss& rho = loss(edge);
  if (rho.trivial()) {
    sink->cost += 0.5 * s;
  } else {
    const internal::RobustScale scale(rho, s);
    sink->cost += scale.cost;
    for_free([&](auto& block) {
      if (scale.alpha_over_s != 0.0) {
        block -= (scale.alpha_over_s * r * (r.transpose() * block)).eval();
      }
      block *= scale.jacobian_scale;
    });
    r *= scale.residual_scale;
  }
  // 0 * x is 0 exactly where x is finite: one test for all entries, no branch per entry.
  double poison = 0.0 * sink->cost;
  for_free([&](const auto& block) { poison += 0.0 * block.sum(); });
  if (poison != 0.0) return false;

  Accumulate(words, r, J, sink);
  return true;
}

template <EdgeType E>
template <int I, int J>
void EdgePool<E>::AccumulatePair(const std::int32_t* words, const Jacobians& jacobians,
                                 NormalEquationsSink* sink) {
  const std::int32_t offset = words[plan::HBlock(kArity, plan::Pair(I, J))];
  if (offset == plan::kNone) return;
  constexpr int kRow = EdgeVertex<E, I>::kTangentDim;
  constexpr int kCol = EdgeVertex<E, J>::kTangentDim;
  const auto& J_row = std::get<I>(jacobians);
  const auto& J_col = std::get<J>(jacobians);
  if (offset >= 0) {
    Eigen::Map<Matrix<kRow, kCol>> H(sink->h_pp + offset);
    H.noalias() += J_row.transpose().lazyProduct(J_col);
  } else {
    Eigen::Map<Matrix<kCol, kRow>> H(sink->h_pp + plan::Transposed(offset));
    H.noalias() += J_col.transpose().lazyProduct(J_row);
  }
}

template <EdgeType E>
template <int I, int L>
void EdgePool<E>::AccumulateW(const std::int32_t* words, const Jacobians& jacobians,
                              NormalEquationsSink* sink) {
  if constexpr (I != L) {
    const std::int32_t offset = words[plan::WBlock(kArity, I)];
    if (offset == plan::kNone) return;
    Eigen::Map<Matrix<EdgeVertex<E, I>::kTangentDim, EdgeVertex<E, L>::kTangentDim>> W(
        sink->landmarks + offset);
    W.noalias() += std::get<I>(jacobians).transpose().lazyProduct(std::get<L>(jacobians));
  }
}

template <EdgeType E>
template <int I>
void EdgePool<E>::AccumulateVertex(const std::int32_t* words, const Vector<kRows>& r,
                                   const Jacobians& jacobians, NormalEquationsSink* sink) {
  constexpr int kDim = EdgeVertex<E, I>::kTangentDim;
  const std::int32_t target = words[plan::Target(kArity, I)];
  if (target == plan::kNone) return;
  const auto& J_i = std::get<I>(jacobians);
  if (target == plan::kLandmark) {
    // Its H_ll and b_l, and W with every free vertex of the edge.
    if constexpr (kDim <= 4) {
      double* const record = sink->landmarks + words[plan::kLandmarkRecord];
      Eigen::Map<SquareMatrix<kDim>> H_ll(record);
      Eigen::Map<Vector<kDim>> b_l(record + kDim * kDim);
      H_ll.noalias() += J_i.transpose().lazyProduct(J_i);
      b_l.noalias() -= J_i.transpose().lazyProduct(r);
      [&]<int... K>(std::integer_sequence<int, K...>) {
        (AccumulateW<K, I>(words, jacobians, sink), ...);
      }
      (std::make_integer_sequence<int, kArity>{});
    }
    return;
  }
  Eigen::Map<Vector<kDim>> b(sink->b_p + target);
  b.noalias() -= J_i.transpose().lazyProduct(r);
  [&]<int... K>(std::integer_sequence<int, K...>) {
    (AccumulatePair<I, K>(words, jacobians, sink), ...);
  }
  (std::make_integer_sequence<int, I + 1>{});
}

template <EdgeType E>
void EdgePool<E>::Accumulate(const std::int32_t* words, const Vector<kRows>& r,
                             const Jacobians& jacobians, NormalEquationsSink* sink) {
  [&]<int... I>(std::integer_sequence<int, I...>) {
    (AccumulateVertex<I>(words, r, jacobians, sink), ...);
  }
  (std::make_integer_sequence<int, kArity>{});
}

}  // namespace glissade
