// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <utility>

#include "glissade/base/matrix.h"
#include "glissade/base/small_matrix.h"
#include "glissade/edges/made_of_doubles.h"
#include "glissade/edges/residual_only.h"
#include "glissade/vertices/view.h"

/// \file
/// Edges whose Evaluate is a template over its scalar type (edges/concept.h): evaluated in packs.
namespace glissade {

/// The members of an edge that differ from edge to edge of a run: doubles, and what is made of
/// nothing else (Vector2 and the like). They come to Evaluate after the vertices, in this order.
template <class E, class... Members>
constexpr std::tuple<Members E::*...> Fields(Members E::*... members) {
  return {members...};
}

namespace internal {

/// Set for the edges that the library evaluates in packs of the machine it runs on
/// (src/lanes); others are compiled where they are added.
template <class E>
inline constexpr bool kLibraryEvaluates = false;

/// Edges of the library whose TwoView() is to be believed, whoever compiles their camera's code.
template <class E>
inline constexpr bool kHasTwoView = kLibraryEvaluates<E>;

/// What a member named in kLanes is to Evaluate.
template <class T, class Member>
struct LaneOf {
  static_assert(
      kMadeOfDoubles<Member>,
      "members in kLanes are double, arrays of double, Vector<N> and the like, or structs of "
      "these and nothing else");
  static constexpr int kSize = sizeof(Member) / sizeof(double);
  using Type = Vec<T, kSize>;
};
template <class T>
struct LaneOf<T, double> {
  static constexpr int kSize = 1;
  using Type = T;
};

/// The same by its place in kLanes: a pointer to a member of the edge, or of what it derives from.
template <class T, class Pointer>
struct LaneAt;
template <class T, class Member, class Class>
struct LaneAt<T, Member Class::*> : LaneOf<T, Member> {};

/// What Evaluate of a template edge takes and gives back: all, or all but the Jacobians.
template <class E, class List, class Lanes>
inline constexpr bool kCanEvaluateLanes = false;
template <class E, class... V, class... M>
inline constexpr bool kCanEvaluateLanes<E, VertexList<V...>, std::tuple<M...>> = requires(
    const E& edge, const View<V, double>&... view, const typename LaneAt<double, M>::Type&... lane,
    Vec<double, E::kResidualDim>& r, Mat<double, E::kResidualDim, V::kTangentDim>*... jacobian) {
  { edge.Evaluate(view..., lane..., r, jacobian...) } -> std::same_as<bool>;
};
template <class E, class List, class Lanes>
inline constexpr bool kCanEvaluateResidual = false;
template <class E, class... V, class... M>
inline constexpr bool kCanEvaluateResidual<E, VertexList<V...>, std::tuple<M...>> =
    requires(const E& edge, const View<V, double>&... view,
             const typename LaneAt<double, M>::Type&... lane, Vec<double, E::kResidualDim>& r) {
  { edge.Evaluate(view..., lane..., r) } -> std::same_as<bool>;
};
/// Whether E's own Evaluate is a template over its scalar: an edge that derives from such a one may
/// have another, which hides it.
template <class E>
inline constexpr bool kIsTemplateEdge = [] {
  if constexpr (requires {
                  typename E::Vertices;
                  E::kLanes;
                }) {
    using Lanes = std::remove_cvref_t<decltype(E::kLanes)>;
    return kCanEvaluateLanes<E, typename E::Vertices, Lanes> ||
           kCanEvaluateResidual<E, typename E::Vertices, Lanes>;
  } else {
    return false;
  }
}();
/// Whether the Jacobians of a template edge are the library's to find.
template <class E>
inline constexpr bool kIsResidualOnly = [] {
  using Lanes = std::remove_cvref_t<decltype(E::kLanes)>;
  return !kCanEvaluateLanes<E, typename E::Vertices, Lanes> &&
         kCanEvaluateResidual<E, typename E::Vertices, Lanes>;
}();

/// The K-th of kLanes. Nothing that runs names E::kLanes itself: what refers to it makes a symbol
/// of it in every unit.
template <class E, std::size_t K>
consteval auto LaneMember() {
  return std::get<K>(E::kLanes);
}
template <class E>
using LaneIndices =
    std::make_index_sequence<std::tuple_size_v<std::remove_cvref_t<decltype(E::kLanes)>>>;

/// Whether kLanes names all there is in an edge.
template <class E>
inline constexpr bool kAllInLanes = []<std::size_t... K>(std::index_sequence<K...>) {
  return std::is_empty_v<E> ||
         (sizeof(std::declval<E&>().*LaneMember<E, K>()) + ... + 0) == sizeof(E);
}
(LaneIndices<E>{});

template <class E, class Member, class Class>
typename LaneOf<double, Member>::Type LaneValue(const E& edge, Member Class::*member) {
  typename LaneOf<double, Member>::Type out;
  std::memcpy(&out, &(edge.*member), sizeof(out));
  return out;
}

/// Single edges say themselves where they have no value; of packs the library tests the results.
template <class T, int N>
bool HasValue(const Vec<T, N>& x) {
  if constexpr (std::is_same_v<T, double>) {
    for (int i = 0; i < N; ++i) {
      if (!std::isfinite(x[i])) return false;
    }
  }
  return true;
}

/// Evaluate of a template edge, for one edge and in the types that other edges use.
template <class E, class... V, class... J>
bool EvaluateInDouble(const E& edge, const std::tuple<const V&...>& vertices,
                      Vector<E::kResidualDim>& r, J*... jacobians) {
  constexpr int kRows = E::kResidualDim;
  Vec<double, kRows> out;
  Bundle<Mat<double, kRows, J::ColsAtCompileTime>...> blocks;
  const auto call = [&]<std::size_t... I, std::size_t... K>(std::index_sequence<I...>,
                                                            std::index_sequence<K...>) {
    if constexpr (kIsResidualOnly<E>) {
      using Evaluator =
          DualEvaluator<E, double, VertexList<V...>,
                        std::remove_cvref_t<decltype(LaneValue(edge, LaneMember<E, K>()))>...>;
      const Bundle<View<V, double>...> views{{ViewOfState<V>(std::get<I>(vertices).Data())}...};
      Bundle<ViewTangent<V, double>...> tangents;
      if (((jacobians != nullptr) || ...)) {
        (FindViewTangent<V>(std::get<I>(vertices).Data(), &Get<I>(tangents)), ...);
      }
      if (!Evaluator::Evaluate(edge, views, tangents, {{LaneValue(edge, LaneMember<E, K>())}...},
                               out, (jacobians != nullptr ? &Get<I>(blocks) : nullptr)...)) {
        return false;
      }
    } else if (!edge.Evaluate(ViewOfState<V>(std::get<I>(vertices).Data())...,
                              LaneValue(edge, LaneMember<E, K>())..., out,
                              (jacobians != nullptr ? &Get<I>(blocks) : nullptr)...)) {
      return false;
    }
    const auto copy = [](const auto& from, auto* to) {
      constexpr int kSize = static_cast<int>(sizeof(from) / sizeof(double));
      for (int i = 0; to != nullptr && i < kSize; ++i)
        to->data()[i] = from[i];
    };
    copy(out, &r);
    (copy(Get<I>(blocks), jacobians), ...);
    return true;
  };
  return call(std::index_sequence_for<V...>{}, LaneIndices<E>{});
}

}  // namespace internal

/// Whether edges of type E are evaluated several at once.
template <class E>
inline constexpr bool kEvaluatesInPacks = [] {
  if constexpr (requires { E::kInLanes; }) {
    return bool(E::kInLanes) && internal::kIsTemplateEdge<E>;
  } else {
    return internal::kIsTemplateEdge<E>;
  }
}();

}  // namespace glissade
