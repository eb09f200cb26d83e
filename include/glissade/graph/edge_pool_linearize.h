// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The loop of EdgePool over edges without a landmark, apart from its bookkeeping (those with one go
// in runs: EvaluateRun). Included by edge_pool.h only.

#include "glissade/graph/edge_pool.h"
#include "glissade/graph/small_blocks.h"
#include "glissade/graph/wide_rows.h"

namespace glissade {

template <EdgeType E>
bool EdgePool<E>::LinearizeOne(const std::int32_t* words, NormalEquationsSink* sink) const {
  const int edge = words[plan::kEdge];
  Vector<kRows> r;
  Jacobians J;
  const bool ok = [&]<std::size_t... I>(std::index_sequence<I...>) {
    if (sink->first_estimates == FirstEstimates::kFull) {
      return EvaluateFirstEstimates(words, r.data(), &J);
    }
    return internal::EvaluateEdge(
        At(edge),
        std::tuple<const EdgeVertex<E, I>&...>(
            std::get<I>(pools_)->At(words[plan::State(static_cast<int>(I))])...),
        r,
        (words[plan::Target(kArity, static_cast<int>(I))] != plan::kNone ? &std::get<I>(J)
                                                                         : nullptr)...);
  }
  (std::make_index_sequence<kArity>{});
  if (!ok) return false;
  if constexpr (internal::IsWide<E>()) return AccumulateWide(words, r.data(), J, sink);

  if (identity_[Index(edge)] == 0) {
    const double* L = sqrt_information(edge);
    internal::MultiplyInPlace<kRows, 1>(L, r.data());
    ForEachIndex<kArity>([&](auto i) {
      if (words[plan::Target(kArity, i)] == plan::kNone) return;
      internal::MultiplyInPlace<kRows, EdgeVertex<E, i>::kTangentDim>(L, std::get<i>(J).data());
    });
  }
  const double s = internal::SquaredNorm<kRows>(r.data());
  if (std::isnan(s)) return false;  // a bounded loss would make a number of it
  const Loss& rho = loss(edge);
  if (rho.trivial()) {
    sink->cost += 0.5 * s;
  } else {
    const internal::RobustScale scale(rho, s);
    sink->cost += scale.cost;
    ForEachIndex<kArity>([&](auto i) {
      if (words[plan::Target(kArity, i)] == plan::kNone) return;
      internal::CorrectJacobian<kRows, EdgeVertex<E, i>::kTangentDim>(scale, r.data(),
                                                                      std::get<i>(J).data());
    });
    for (int k = 0; k < kRows; ++k)
      r.data()[k] *= scale.residual_scale;
  }
  double poison = 0.0 * sink->cost;
  ForEachIndex<kArity>([&](auto i) {
    if (words[plan::Target(kArity, i)] == plan::kNone) return;
    poison += internal::Poison<kRows * EdgeVertex<E, i>::kTangentDim>(std::get<i>(J).data());
  });
  if (poison != 0.0) return false;

  [&]<int... I>(std::integer_sequence<int, I...>) {
    (AccumulateVertex<I>(words, r.data(), J, sink), ...);
  }
  (std::make_integer_sequence<int, kArity>{});
  return true;
}

template <EdgeType E>
bool EdgePool<E>::EvaluateFirstEstimates(const std::int32_t* words, double* residual,
                                         Jacobians* jacobians) const {
  const double *states[kArity], *points[kArity];
  double* J[kArity];
  ForEachIndex<kArity>([&](auto i) {
    const auto* pool = std::get<i>(pools_);
    const std::int32_t vertex = words[plan::State(i)];
    states[i] = pool->At(vertex).Data();
    points[i] = pool->first_estimates().At(vertex);
    J[i] = words[plan::Target(kArity, i)] != plan::kNone ? std::get<i>(*jacobians).data() : nullptr;
  });
  return EvaluateAt(words[plan::kEdge], states, points, residual, J);
}

template <EdgeType E>
bool EdgePool<E>::AccumulateWide(const std::int32_t* words, const double* r,
                                 const Jacobians& jacobians, NormalEquationsSink* sink) const {
  // The rows [J | r] side by side; what a fixed vertex has no Jacobian for stays zero.
  constexpr int kStride = internal::WideStride<E>(), kDims = internal::FirstColumn<E>(kArity);
  double panel[kRows * kStride] = {}, work[kRows * kStride], products[kStride * kStride];
  int column = 0;
  ForEachIndex<kArity>([&](auto i) {
    constexpr int kDim = EdgeVertex<E, i>::kTangentDim;
    const double* J_i = std::get<i>(jacobians).data();
    for (int k = 0; k < kRows && words[plan::Target(kArity, i)] != plan::kNone; ++k) {
      for (int c = 0; c < kDim; ++c)
        panel[k * kStride + column + c] = J_i[k * kDim + c];
    }
    column += kDim;
  });
  for (int k = 0; k < kRows; ++k)
    panel[k * kStride + kDims] = r[k];

  const int edge = words[plan::kEdge];
  const double* L = identity_[Index(edge)] != 0 ? nullptr : sqrt_information(edge);
  if (!internal::SquareRows(kRows, kDims, kStride, L, loss(edge), panel, work, products,
                            &sink->cost)) {
    return false;
  }
  const double* gradient = products + kDims;
  [&]<int... I>(std::integer_sequence<int, I...>) {
    (ScatterWide<I>(words, products, gradient, sink), ...);
  }
  (std::make_integer_sequence<int, kArity>{});
  return true;
}

template <EdgeType E>
template <int I>
void EdgePool<E>::ScatterWide(const std::int32_t* words, const double* products,
                              const double* gradient, NormalEquationsSink* sink) {
  constexpr int kStride = internal::WideStride<E>();
  constexpr int kRow = EdgeVertex<E, I>::kTangentDim;
  constexpr int kFirst = internal::FirstColumn<E>(I);
  const std::int32_t target = words[plan::Target(kArity, I)];
  if (target == plan::kNone) return;
  for (int k = 0; k < kRow; ++k)
    sink->b_p[target + k] += gradient[(kFirst + k) * kStride];
  ForEachIndex<I + 1>([&](auto j) {
    const std::int32_t offset = words[plan::HBlock(kArity, plan::Pair(I, j))];
    if (offset == plan::kNone) return;
    constexpr int kCol = EdgeVertex<E, j>::kTangentDim;
    const double* block = products + internal::FirstColumn<E>(j) * kStride + kFirst;
    if (j == I) {
      internal::SubtractLower<kRow, kStride>(block, sink->h_pp + offset);
    } else if (offset >= 0) {
      internal::SubtractTransposed<kRow, kCol, kStride>(block, sink->h_pp + offset);
    } else {
      internal::SubtractBlock<kCol, kRow, kStride>(block, sink->h_pp + plan::Transposed(offset));
    }
  });
}

template <EdgeType E>
template <int I, int J>
void EdgePool<E>::AccumulatePair(const std::int32_t* words, const Jacobians& jacobians,
                                 NormalEquationsSink* sink) {
  const std::int32_t offset = words[plan::HBlock(kArity, plan::Pair(I, J))];
  if (offset == plan::kNone) return;
  constexpr int kRow = EdgeVertex<E, I>::kTangentDim;
  constexpr int kCol = EdgeVertex<E, J>::kTangentDim;
  const double* J_row = std::get<I>(jacobians).data();
  const double* J_col = std::get<J>(jacobians).data();
  if (offset >= 0) {
    internal::AddTransposedProduct<kRows, kRow, kCol>(1.0, J_row, J_col, sink->h_pp + offset);
  } else {
    internal::AddTransposedProduct<kRows, kCol, kRow>(1.0, J_col, J_row,
                                                      sink->h_pp + plan::Transposed(offset));
  }
}

template <EdgeType E>
template <int I>
void EdgePool<E>::AccumulateVertex(const std::int32_t* words, const double* r,
                                   const Jacobians& jacobians, NormalEquationsSink* sink) {
  constexpr int kDim = EdgeVertex<E, I>::kTangentDim;
  const std::int32_t target = words[plan::Target(kArity, I)];
  if (target == plan::kNone) return;
  const double* J_i = std::get<I>(jacobians).data();
  internal::AddTransposedProduct<kRows, kDim, 1>(-1.0, J_i, r, sink->b_p + target);
  [&]<int... K>(std::integer_sequence<int, K...>) {
    (AccumulatePair<I, K>(words, jacobians, sink), ...);
  }
  (std::make_integer_sequence<int, I + 1>{});
}

}  // namespace glissade
