// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The hot loop of EdgePool, apart from its bookkeeping. Included by edge_pool.h only.

#include "glissade/graph/edge_pool.h"

namespace glissade {

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
  }(std::make_index_sequence<kArity>{});
  if (!ok) return false;

  const auto for_free = [&](auto&& f) {
    ForEachIndex<kArity>([&](auto i) {
      if (words[plan::Target(kArity, i)] != plan::kNone) f(std::get<i>(J));
    });
  };
  if (identity_[Index(edge)] == 0) {
    const SqrtInformation& L = sqrt_information(edge);
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
void EdgePool<E>::Accumulate(const std::int32_t* words, const Vector<kRows>& r, const Jacobians& J,
                             NormalEquationsSink* sink) const {
  double* const record = sink->landmarks + words[plan::kLandmarkRecord];
  ForEachIndex<kArity>([&](auto i) {
    constexpr int kDim = EdgeVertex<E, i>::kTangentDim;
    const std::int32_t target = words[plan::Target(kArity, i)];
    if (target == plan::kNone) return;
    const auto& J_i = std::get<i>(J);

    if (target == plan::kLandmark) {
      // Landmark i: its H_ll and b_l, and W with every free vertex of the edge.
      if constexpr (kDim <= 4) {
        Eigen::Map<SquareMatrix<kDim>> H_ll(record);
        Eigen::Map<Vector<kDim>> b_l(record + kDim * kDim);
        H_ll.noalias() += J_i.transpose().lazyProduct(J_i);
        b_l.noalias() -= J_i.transpose().lazyProduct(r);
        ForEachIndex<kArity>([&](auto j) {
          if constexpr (j != i) {
            const std::int32_t w = words[plan::WBlock(kArity, j)];
            if (w == plan::kNone) return;
            Eigen::Map<Matrix<EdgeVertex<E, j>::kTangentDim, kDim>> W(sink->landmarks + w);
            W.noalias() += std::get<j>(J).transpose().lazyProduct(J_i);
          }
        });
      }
      return;
    }

    Eigen::Map<Vector<kDim>> b(sink->b_p + target);
    b.noalias() -= J_i.transpose().lazyProduct(r);
    ForEachIndex<i + 1>([&](auto j) {
      const std::int32_t offset = words[plan::HBlock(kArity, plan::Pair(i, j))];
      if (offset == plan::kNone) return;
      constexpr int kOther = EdgeVertex<E, j>::kTangentDim;
      const auto& J_j = std::get<j>(J);
      if (offset >= 0) {
        Eigen::Map<Matrix<kDim, kOther>> H(sink->h_pp + offset);
        H.noalias() += J_i.transpose().lazyProduct(J_j);
      } else {
        Eigen::Map<Matrix<kOther, kDim>> H(sink->h_pp + plan::Transposed(offset));
        H.noalias() += J_j.transpose().lazyProduct(J_i);
      }
    });
  });
}

}  // namespace glissade
