// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstring>
#include <type_traits>
#include <utility>

#include "glissade/base/bundle.h"
#include "glissade/base/dual.h"
#include "glissade/vertices/view.h"

/// \file
/// Jacobians of edges whose Evaluate is a template over its scalar and leaves them to the library:
/// from dual numbers along the tangents of all vertices.
namespace glissade {

template <VertexType... V>
struct VertexList;

namespace internal {

/// d(numbers of View<V, T>) / d(tangent), numbers x kTangentDim, row-major.
template <class V, class T>
struct ViewTangent {
  static constexpr int kNumbers = static_cast<int>(sizeof(View<V, double>) / sizeof(double));
  T d[kNumbers * V::kTangentDim];
};

/// The same for one state: of a pose and where boxplus is a sum as it is, of other types by
/// differences of sixth order (to about 1e-13 of the largest number of the view).
template <class V>
void FindViewTangent(const double* state, ViewTangent<V, double>* out) {
  constexpr int kNumbers = ViewTangent<V, double>::kNumbers, kDim = V::kTangentDim;
  for (double& x : out->d)
    x = 0.0;
  if constexpr (std::is_same_v<V, VertexPose>) {
    // p + dp, R Exp(dtheta): column j of R [e_k]x is R (e_k x e_j).
    const View<VertexPose, double> view = ViewOfState<VertexPose>(state);
    for (int row = 0; row < 3; ++row) {
      for (int j = 0; j < 3; ++j) {
        double* d = out->d + (3 * row + j) * kDim + 3;
        const int next = (j + 1) % 3, last = (j + 2) % 3;
        d[next] = -view.R(row, last);
        d[last] = view.R(row, next);
      }
      out->d[(9 + row) * kDim + row] = 1.0;
    }
  } else if constexpr (kViewIsState<V> && kIsAdditive<V>) {
    for (int n = 0; n < kDim; ++n)
      out->d[n * kDim + n] = 1.0;
  } else {
    constexpr double kStep = 1e-2, kWeights[] = {45.0, -9.0, 1.0};
    for (int c = 0; c < kDim; ++c) {
      for (int k = 1; k <= 3; ++k) {
        for (const double sign : {1.0, -1.0}) {
          double delta[kDim] = {}, numbers[kNumbers];
          delta[c] = sign * k * kStep;
          V moved = VertexFromData<V>(state);
          moved.Plus(delta);
          const View<V, double> view = ViewOfState<V>(moved.Data());
          std::memcpy(numbers, &view, sizeof(view));
          for (int n = 0; n < kNumbers; ++n)
            out->d[n * kDim + c] += sign * kWeights[k - 1] / (60.0 * kStep) * numbers[n];
        }
      }
    }
  }
}

/// Evaluates such an edge. List: its VertexList; Lane: what members of kLanes are to Evaluate.
template <class E, class T, class List, class... Lane>
struct DualEvaluator;

template <class E, class T, class... V, class... Lane>
struct DualEvaluator<E, T, VertexList<V...>, Lane...> {
  static constexpr int kRows = E::kResidualDim;
  static constexpr int kSize = (V::kTangentDim + ... + 0);
  using D = Dual<T, kSize>;
  template <std::size_t I>
  static constexpr int kFirst = [] {
    constexpr int kDims[] = {V::kTangentDim...};
    int first = 0;
    for (std::size_t i = 0; i < I; ++i)
      first += kDims[i];
    return first;
  }();

  /// A member of kLanes as constants.
  template <class Value>
  static auto Constant(const Value& value) {
    if constexpr (std::is_same_v<Value, T>) {
      return D(value);
    } else {
      constexpr int kNumbers = static_cast<int>(sizeof(Value) / sizeof(T));
      Vec<D, kNumbers> out;
      for (int n = 0; n < kNumbers; ++n)
        out[n] = D(value[n]);
      return out;
    }
  }

  template <class Vertex, int kFirstColumn>
  static View<Vertex, D> Seed(const View<Vertex, T>& view, const ViewTangent<Vertex, T>& tangent) {
    constexpr int kNumbers = ViewTangent<Vertex, T>::kNumbers, kDim = Vertex::kTangentDim;
    static_assert(sizeof(View<Vertex, D>) == kNumbers * sizeof(D),
                  "a View consists of numbers T only");
    View<Vertex, D> out;
    for (int n = 0; n < kNumbers; ++n) {
      T value;
      std::memcpy(&value, reinterpret_cast<const char*>(&view) + n * sizeof(T), sizeof(T));
      D number(value);
      for (int c = 0; c < kDim; ++c)
        number.d[kFirstColumn + c] = tangent.d[n * kDim + c];
      std::memcpy(reinterpret_cast<char*>(&out) + n * sizeof(D), &number, sizeof(D));
    }
    return out;
  }

  static bool Evaluate(const E& edge, const Bundle<View<V, T>...>& views,
                       const Bundle<ViewTangent<V, T>...>& tangents, const Bundle<Lane...>& lanes,
                       Vec<T, kRows>& r, Mat<T, kRows, V::kTangentDim>*... jacobians) {
    return [&]<std::size_t... I, std::size_t... K>(std::index_sequence<I...>,
                                                   std::index_sequence<K...>) {
      if (((jacobians == nullptr) && ...))
        return edge.Evaluate(Get<I>(views)..., Get<K>(lanes)..., r);
      Vec<D, kRows> out;
      if (!edge.Evaluate(Seed<V, kFirst<I>>(Get<I>(views), Get<I>(tangents))...,
                         Constant(Get<K>(lanes))..., out)) {
        return false;
      }
      for (int row = 0; row < kRows; ++row)
        r[row] = out[row].a;
      const auto copy = [&](int first, int columns, auto* jacobian) {
        for (int row = 0; jacobian != nullptr && row < kRows; ++row) {
          for (int c = 0; c < columns; ++c)
            (*jacobian)(row, c) = out[row].d[first + c];
        }
      };
      (copy(kFirst<I>, V::kTangentDim, jacobians), ...);
      return true;
    }
    (std::index_sequence_for<V...>{}, std::index_sequence_for<Lane...>{});
  }
};

}  // namespace internal
}  // namespace glissade
