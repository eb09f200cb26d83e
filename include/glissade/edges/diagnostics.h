// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <tuple>
#include <type_traits>
#include <utility>

#include "glissade/edges/concept.h"

/// \file
/// What a compiler says where a vertex type, an edge type, or the handles that an edge is added
/// with are wrong. A concept that fails makes "no matching function" and a page of candidates;
/// these checks make one static_assert, and the compiler's own line above it shows the expected
/// signature as the template argument `Expected`.
namespace glissade {

/// Vector<R> and Jacobian<R, C> by these names, for messages.
namespace expected {
template <int Rows>
struct Vector;
template <int Rows, int Cols>
struct Jacobian;
/// {host, target, depth}
template <class... Handles>
struct Braces;
}  // namespace expected

namespace internal {

/// Stand in for the arguments of Evaluate that are not looked at.
struct AnyPointer {
  template <class T>
  operator T*() const;
};
struct AnyReference {
  template <class T>
  operator T&() const;
};
template <class>
using AnyPointerFor = AnyPointer;

template <class E, class... V>
constexpr bool TakesVertices(VertexList<V...>) {
  return requires(const E& edge, const V&... vertex, AnyReference r, AnyPointerFor<V>... jacobian) {
    edge.Evaluate(vertex..., r, jacobian...);
  };
}

template <class E, class... V>
constexpr bool TakesResidual(VertexList<V...>) {
  return requires(const E& edge, const V&... vertex, Vector<E::kResidualDim>& r,
                  AnyPointerFor<V>... jacobian) {
    edge.Evaluate(vertex..., r, jacobian...);
  };
}

template <class E, int K, class... V, int... I>
constexpr bool TakesJacobian(VertexList<V...>, std::integer_sequence<int, I...>) {
  return requires(
      const E& edge, const V&... vertex, Vector<E::kResidualDim>& r,
      std::conditional_t<I == K, Jacobian<E::kResidualDim, V::kTangentDim>*, AnyPointer>... j) {
    edge.Evaluate(vertex..., r, j...);
  };
}

/// The first vertex whose Jacobian has the wrong type; their number if all fit one by one.
template <class E>
constexpr int WrongJacobian() {
  using List = typename E::Vertices;
  int wrong = List::kSize;
  ForEachIndex<List::kSize>([&](auto k) {
    constexpr int kAt = List::kSize - 1 - k;
    if (!TakesJacobian<E, kAt>(List{}, std::make_integer_sequence<int, List::kSize>{})) wrong = kAt;
  });
  return wrong;
}

/// E may be const or not, to see which of the two can be called.
template <class E, class... V>
constexpr bool CanBeCalled(VertexList<V...>) {
  return requires(E & edge, const V&... vertex, Vector<E::kResidualDim>& r,
                  Jacobian<E::kResidualDim, V::kTangentDim>*... jacobian) {
    edge.Evaluate(vertex..., r, jacobian...);
  };
}

template <class E, class List>
struct ExpectedEvaluate;
template <class E, class... V>
struct ExpectedEvaluate<E, VertexList<V...>> {
  using Type = bool(const V&..., expected::Vector<E::kResidualDim>&,
                    expected::Jacobian<E::kResidualDim, V::kTangentDim>*...) const;
};

/// Says what is wrong with Evaluate. Expected is only there to be shown.
template <class E, class Expected, int kWrongJacobian>
constexpr void ExplainEvaluate() {
  constexpr typename E::Vertices kVertices{};
  if constexpr (CanBeCalled<const E>(kVertices)) {
    static_assert(!CanBeCalled<const E>(kVertices), "Evaluate must return bool: see Expected");
  } else if constexpr (CanBeCalled<E>(kVertices)) {
    static_assert(!CanBeCalled<E>(kVertices), "Evaluate must be const: see Expected");
  } else if constexpr (!TakesVertices<E>(kVertices)) {
    static_assert(TakesVertices<E>(kVertices),
                  "Evaluate must take the vertices in the order of Vertices, the residual, and a "
                  "Jacobian pointer for each vertex: see Expected");
  } else if constexpr (!TakesResidual<E>(kVertices)) {
    static_assert(TakesResidual<E>(kVertices),
                  "Evaluate: the residual has the wrong type: see Expected");
  } else {
    static_assert(kWrongJacobian != 0,
                  "Evaluate: the Jacobian of vertex 0 has the wrong type: see "
                  "Expected");
    static_assert(kWrongJacobian != 1,
                  "Evaluate: the Jacobian of vertex 1 has the wrong type: see "
                  "Expected");
    static_assert(kWrongJacobian != 2,
                  "Evaluate: the Jacobian of vertex 2 has the wrong type: see "
                  "Expected");
    static_assert(
        kWrongJacobian < 3,
        "Evaluate: the Jacobian of vertex kWrongJacobian has the wrong type: see Expected");
  }
}

template <class E, class List, class Lanes>
struct ExpectedInPacks;
template <class E, class... V, class... M>
struct ExpectedInPacks<E, VertexList<V...>, std::tuple<M...>> {
  using Type = bool(const View<V, double>&..., const typename LaneAt<double, M>::Type&...,
                    Vec<double, E::kResidualDim>&,
                    Mat<double, E::kResidualDim, V::kTangentDim>*...) const;
};

/// The same for an Evaluate that is a template over its scalar.
template <class E, class Expected>
constexpr void ExplainInPacks() {
  static_assert(kIsTemplateEdge<E>,
                "an edge with kLanes has an Evaluate that is a template over the scalar T (here "
                "double), const, returns bool, and takes a View of each vertex, the members named "
                "in kLanes, the residual, and a Jacobian pointer for each vertex: see Expected");
}

template <class E>
constexpr void ExplainEdge() {
  if constexpr (!EdgeHasVertices<E>) {
    static_assert(EdgeHasVertices<E>, "an edge type declares `using Vertices = VertexList<...>`");
  } else if constexpr (!EdgeHasResidualDim<E>) {
    static_assert(EdgeHasResidualDim<E>,
                  "an edge type declares `static constexpr int kResidualDim`, at least 1");
  } else if constexpr (!EdgeHasEvaluate<E> && requires { E::kLanes; }) {
    ExplainInPacks<E, typename ExpectedInPacks<E, typename E::Vertices,
                                               std::remove_cvref_t<decltype(E::kLanes)>>::Type>();
  } else if constexpr (!EdgeHasEvaluate<E>) {
    ExplainEvaluate<E, typename ExpectedEvaluate<E, typename E::Vertices>::Type,
                    WrongJacobian<E>()>();
  } else if constexpr (!EdgeFitsFirstEstimateRule<E>) {
    static_assert(EdgeFitsFirstEstimateRule<E>,
                  "kFirstEstimateRule: vertices 0 and 1 must be of type VertexPose for "
                  "kRelativePose, a VertexPose and a VertexPointXYZ for kRelativePoint");
  } else {
    static_assert(std::copyable<E>, "an edge type is a plain value: it must be copyable");
  }
}

/// `Type` is a list of vertex types, empty for what is no edge type at all.
template <class E>
struct VerticesOf {
  using Type = VertexList<>;
};
template <EdgeHasVertices E>
struct VerticesOf<E> {
  using Type = typename E::Vertices;
};

/// The handles do not fit: how many there are, of which types, and in which order, is shown.
template <class E, class Given, class Expected>
constexpr void ExplainHandles() {
  constexpr bool kFit = std::is_same_v<Given, Expected>;
  static_assert(kFit,
                "AddEdge: the handles must be those of the edge's Vertices, in their order: see "
                "Given and Expected");
}

}  // namespace internal

/// The vertices an edge of type E is added to: `{host, target, depth}`, handles or the Results that
/// hold them, in the order of E::Vertices; or a tuple of handles.
template <class E, class List = typename internal::VerticesOf<E>::Type>
class EdgeVertices;

template <class E, class... V>
class EdgeVertices<E, VertexList<V...>> {
 public:
  using Handles = std::tuple<VertexHandle<V>...>;

  template <class... H>
  static constexpr bool Fit() {
    if constexpr (sizeof...(H) == sizeof...(V)) {
      return (std::convertible_to<const H&, VertexHandle<V>> && ...);
    } else {
      return false;
    }
  }

  EdgeVertices() = default;
  EdgeVertices(const VertexHandle<V>&... handles)  // NOLINT: implicit, {host, target, depth}
      requires(sizeof...(V) > 0)
      : handles_(handles...) {}
  /// Results that hold handles: as they are given, so that the one Result of an edge on one vertex
  /// is not taken for what can be converted to EdgeVertices.
  template <class... H>
  requires(sizeof...(V) > 0 && Fit<H...>()) EdgeVertices(const H&... handles)  // NOLINT: implicit
      : handles_(static_cast<VertexHandle<V>>(handles)...) {}
  template <std::same_as<Handles> T>
  EdgeVertices(const T& handles)  // NOLINT: implicit
      : handles_(handles) {}
  /// Chosen for all else, to say why it cannot be.
  template <class... H>
  requires(!Fit<H...>()) EdgeVertices(const H&...) {  // NOLINT: implicit
    if constexpr (EdgeHasVertices<E>) {
      internal::ExplainHandles<E, expected::Braces<H...>, expected::Braces<VertexHandle<V>...>>();
    }
  }

  [[nodiscard]] const Handles& handles() const { return handles_; }

 private:
  Handles handles_;
};

}  // namespace glissade
