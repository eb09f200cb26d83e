// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "glissade/base/matrix.h"
#include "glissade/edges/lanes.h"
#include "glissade/vertices/concept.h"

/// \file
/// What a type must offer to be a typed edge (a residual term). An edge is a plain value and a
/// stateless function of its vertices:
///
///     struct EdgeRange {
///       using Vertices = VertexList<VertexPose, VertexPointXYZ>;
///       static constexpr int kResidualDim = 1;
///       double measured;
///       bool Evaluate(const VertexPose& pose, const VertexPointXYZ& point, Vector<1>& r,
///                     Jacobian<1, 6>* d_r_d_pose, Jacobian<1, 3>* d_r_d_point) const;
///       Status Validate() const;   // optional: refuse an impossible measurement when added
///     };
///
/// Evaluate writes the residual (predicted - measured, unweighted) and, through each Jacobian
/// pointer that is not null, the derivative with respect to that vertex's tangent. It returns false
/// only where no number exists (a division by zero), never because a result is implausible.
/// It must be safe to call from several threads.
///
/// Evaluate may be a template over the scalar type instead; edges on the same vertices but for the
/// landmark are then evaluated in packs, several at once (base/pack.h):
///
///       static constexpr auto kLanes = Fields(&EdgeRange::measured);   // differ from edge to edge
///       template <class T>
///       bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
///                     const T& measured, Vec<T, 1>& r, Mat<T, 1, 6>* d_r_d_pose,
///                     Mat<T, 1, 3>* d_r_d_point) const;
///
/// Without the Jacobian arguments it computes the residual alone; the library then has the
/// Jacobians from dual numbers (base/dual.h), which takes several times as long.
///
/// Members that are not in kLanes must be equal in all edges of a run: SameSensor (or SameInRun,
/// where the two differ) tells. One that is inherited does not do for an edge that adds members to
/// its base. A condition on T is that of the first lane; if another lane has it otherwise, the
/// edges are evaluated once more one by one.
///
/// Exceptions. What Evaluate throws, or a loss, an iteration callback, a linear solver of yours or
/// a drop_if, comes out of Solve (or Marginalize, Covariance, ...) on the thread that called it,
/// for any number of threads the same one: that of the first piece of work in the library's order.
/// The graph then holds the best state so far (after Marginalize: what it held before), nothing of
/// a gauge is left in it, and graph and Problem can be used on. std::bad_alloc alone does not come
/// out: it becomes the status kOutOfMemory.
///
/// Optional members:
///
///     static constexpr bool kIsObservation = true;  // two on the same vertices with
///     bool SameSensor(const EdgeX& other) const;    //   SameSensor true are duplicates
///     double Depth(const V&... vertices) const;     // [m]; for DepthOf and GetOutlierEdges
///     static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;  // see there
///     static constexpr unsigned kNoFirstEstimate = 1u << 3;  // bit i: vertex i is always
///                                                            //   linearized where it is
///     static constexpr auto kScaleRule = ScaleRule::kRays;   // see there
///     static constexpr int kExtrinsicVertex = 3;    // this vertex is T_b_c of the camera,
///     Pose T_b_c;                                   //   or the edge has it: camera in body
namespace glissade {

struct Pose;
struct VertexPose;
struct VertexPointXYZ;

/// How an edge is linearized where its vertices have linearization points x_lin other than their
/// present values x (first estimates in full, graph/first_estimates.h). The residual is that of x.
enum class FirstEstimateRule {
  /// All of the Jacobian at x_lin. Default.
  kWhole,
  /// Vertices 0 and 1 are poses T_W_A, T_W_B that enter as T_W_B^-1 T_W_A only:
  /// d(residual)/d(relative pose) at x, d(relative pose)/d(poses) at x_lin, all else at x.
  kRelativePose,
  /// Vertices 0 and 1 are a pose and a VertexPointXYZ that enter as T_W_B^-1 X only; likewise.
  kRelativePoint,
};

/// What an edge says of the scale of the scene: whether a gauge has a direction of scale (Orbit,
/// gauge/orbit.h) is asked of all edges.
enum class ScaleRule {
  /// It measures lengths: IMU, stereo, ranges, relative poses. Default.
  kMetric,
  /// Rays of one camera, blind to scale as long as the camera has the same place in the body for
  /// all: that of kExtrinsicVertex or T_b_c, or the body itself for an edge that has neither.
  kRays,
  /// A prior, which holds what it holds. The others are asked.
  kPrior,
};

/// The vertex types an edge connects, in the order of Evaluate's arguments.
template <VertexType... V>
struct VertexList {
  static constexpr int kSize = sizeof...(V);
  using Handles = std::tuple<VertexHandle<V>...>;
  template <int I>
  using Type = std::tuple_element_t<static_cast<std::size_t>(I), std::tuple<V...>>;
};

/// The I-th vertex type of edge type E.
template <class E, int I>
using EdgeVertex = typename E::Vertices::template Type<I>;

// clang-format 14 takes concepts apart.
// clang-format off
template <class E>
concept EdgeHasVertices = requires {
  typename E::Vertices;
  { E::Vertices::kSize } -> std::convertible_to<int>;
} && (E::Vertices::kSize >= 1);

template <class E>
concept EdgeHasResidualDim = requires {
  { E::kResidualDim } -> std::convertible_to<int>;
} && (E::kResidualDim >= 1);

namespace internal {
template <class E, class List>
inline constexpr bool kCanEvaluate = false;
template <class E, class... V>
inline constexpr bool kCanEvaluate<E, VertexList<V...>> =
    requires(const E& edge, const V&... vertex, Vector<E::kResidualDim>& r,
             Jacobian<E::kResidualDim, V::kTangentDim>*... jacobian) {
      { edge.Evaluate(vertex..., r, jacobian...) } -> std::same_as<bool>;
    };

template <class E>
constexpr FirstEstimateRule FirstEstimateRuleOf() {
  if constexpr (requires { E::kFirstEstimateRule; }) {
    return E::kFirstEstimateRule;
  } else {
    return FirstEstimateRule::kWhole;
  }
}

template <class E>
constexpr bool FitsFirstEstimateRule() {
  constexpr FirstEstimateRule kRule = FirstEstimateRuleOf<E>();
  if constexpr (kRule == FirstEstimateRule::kWhole) {
    return true;
  } else if constexpr (E::Vertices::kSize < 2) {
    return false;
  } else {
    using Second = std::conditional_t<kRule == FirstEstimateRule::kRelativePose, VertexPose,
                                      VertexPointXYZ>;
    return std::is_same_v<EdgeVertex<E, 0>, VertexPose> &&
           std::is_same_v<EdgeVertex<E, 1>, Second>;
  }
}
}  // namespace internal

/// `bool Evaluate(const V&..., Vector<R>& r, Jacobian<R, V::kTangentDim>*...) const`, or with kLanes
/// `bool Evaluate(const View<V, T>&..., lanes..., Vec<T, R>& r, Mat<T, R, V::kTangentDim>*...) const`
/// or the same without Jacobians
template <class E>
concept EdgeHasEvaluate =
    internal::kCanEvaluate<E, typename E::Vertices> || internal::kIsTemplateEdge<E>;

/// kFirstEstimateRule, if there is one, is for edges on these vertices.
template <class E>
concept EdgeFitsFirstEstimateRule = internal::FitsFirstEstimateRule<E>();

template <class E>
concept EdgeType = std::copyable<E> && EdgeHasVertices<E> && EdgeHasResidualDim<E> &&
                   EdgeHasEvaluate<E> && EdgeFitsFirstEstimateRule<E>;
// clang-format on

/// The optional members of an edge type, at run time.
struct EdgeTraits {
  FirstEstimateRule first_estimate_rule = FirstEstimateRule::kWhole;
  unsigned no_first_estimate = 0;
  ScaleRule scale_rule = ScaleRule::kMetric;
  int extrinsic_vertex = -1;  ///< negative: none
  bool is_observation = false;
};

namespace internal {

template <class E>
constexpr int ExtrinsicVertexOf() {
  if constexpr (requires { E::kExtrinsicVertex; }) {
    static_assert(0 <= E::kExtrinsicVertex && E::kExtrinsicVertex < E::Vertices::kSize,
                  "kExtrinsicVertex is one of the edge's vertices");
    static_assert(std::is_same_v<EdgeVertex<E, E::kExtrinsicVertex>, VertexPose>,
                  "kExtrinsicVertex: an extrinsic is a VertexPose");
    return E::kExtrinsicVertex;
  } else {
    return -1;
  }
}

}  // namespace internal

template <class E>
inline constexpr EdgeTraits kEdgeTraits = [] {
  EdgeTraits traits;
  traits.first_estimate_rule = internal::FirstEstimateRuleOf<E>();
  traits.extrinsic_vertex = internal::ExtrinsicVertexOf<E>();
  if constexpr (requires { E::kNoFirstEstimate; }) traits.no_first_estimate = E::kNoFirstEstimate;
  if constexpr (requires { E::kScaleRule; }) traits.scale_rule = E::kScaleRule;
  if constexpr (requires { E::kIsObservation; }) traits.is_observation = E::kIsObservation;
  return traits;
}();

/// The handles an edge of type E is added with: a tuple, so `{host, target, depth}` does.
template <class E>
using EdgeVertexHandles = typename E::Vertices::Handles;

namespace internal {
/// Evaluate of one edge, whichever form it has.
template <class E, class... V, class... J>
bool EvaluateEdge(const E& edge, const std::tuple<const V&...>& vertices,
                  Vector<E::kResidualDim>& r, J*... jacobians) {
  if constexpr (kCanEvaluate<E, typename E::Vertices>) {
    return std::apply([&](const auto&... v) { return edge.Evaluate(v..., r, jacobians...); },
                      vertices);
  } else {
    return EvaluateInDouble(edge, vertices, r, jacobians...);
  }
}
}  // namespace internal

/// Calls f(std::integral_constant<int, 0>{}), ..., f(<N - 1>).
template <int N, class F>
constexpr void ForEachIndex(F&& f) {
  // clang-format off
  [&]<int... I>(std::integer_sequence<int, I...>) {
    (f(std::integral_constant<int, I>{}), ...);
  }(std::make_integer_sequence<int, N>{});
  // clang-format on
}

}  // namespace glissade
