// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstddef>
#include <new>
#include <tuple>
#include <type_traits>
#include <utility>

#include "glissade/base/status.h"
#include "glissade/base/value_array.h"
#include "glissade/edges/concept.h"
#include "glissade/edges/same_in_run.h"
#include "glissade/edges/two_view_observation.h"

namespace glissade {

/// More vertices than that make a dynamic edge.
inline constexpr int kMaxTypedArity = 16;

/// An edge type at run time: all that its pool (graph/edge_pool.h) knows of it, and all that is
/// compiled for it where it is added. Null functions: the type has none.
struct EdgeOps {
  const TypeInfo* type;
  EdgeTraits traits;
  internal::ValueOps value;
  int arity;
  int rows;
  const TypeInfo* const* vertex_types;
  /// Residual and Jacobians as the edge has them (row-major, rows x tangent), at states that are
  /// given as their numbers. jacobians may be null, or null for some vertices. On failure they hold
  /// anything.
  bool (*evaluate)(const void* edge, const double* const* states, double* residual,
                   double* const* jacobians);
  Status (*validate)(const void* edge);
  double (*depth)(const void* edge, const double* const* states);
  bool (*same_sensor)(const void* edge, const void* other);
  bool (*same_in_run)(const void* edge, const void* other);
  const double* (*extrinsic)(const void* edge);  ///< T_b_c that it carries
  void (*two_view)(const void* edge, TwoViewObservation*);
};

namespace internal {

/// Memory of the caller's begins to live as the Jacobian that Evaluate takes.
template <int kRows, int kDim>
Jacobian<kRows, kDim>* JacobianAt(double* const* jacobians, std::size_t i) {
  static_assert(sizeof(Jacobian<kRows, kDim>) == sizeof(double) * kRows * kDim);
  if (jacobians == nullptr || jacobians[i] == nullptr) return nullptr;
  return ::new (static_cast<void*>(jacobians[i])) Jacobian<kRows, kDim>;
}

/// The EdgeOps of E. Those of the library's own types are compiled in the library alone: their
/// headers declare them `extern template`.
template <class E, class List = typename E::Vertices>
struct EdgeOpsOf;

template <class E, class... V>
struct EdgeOpsOf<E, VertexList<V...>> {
  static const TypeInfo* const kVertexTypes[sizeof...(V)];
  static const EdgeOps kOps;

  static bool Evaluate(const void* edge, const double* const* states, double* residual,
                       double* const* jacobians);
  static constexpr EdgeOps Make();
};

template <class E, class... V>
bool EdgeOpsOf<E, VertexList<V...>>::Evaluate(const void* edge, const double* const* states,
                                              double* residual, double* const* jacobians) {
  constexpr int kRows = E::kResidualDim;
  static_assert(sizeof(Vector<kRows>) == sizeof(double) * kRows);
  const E& e = *static_cast<const E*>(edge);
  auto& r = *::new (static_cast<void*>(residual)) Vector<kRows>;
  return [&]<std::size_t... I>(std::index_sequence<I...>)->bool {
    if constexpr (kCanEvaluate<E, VertexList<V...>>) {
      return e.Evaluate(VertexFromData<V>(states[I])..., r,
                        JacobianAt<kRows, V::kTangentDim>(jacobians, I)...);
    } else {
      return EvaluateInDouble(e, std::tuple<const V&...>(VertexFromData<V>(states[I])...), r,
                              JacobianAt<kRows, V::kTangentDim>(jacobians, I)...);
    }
  }
  (std::index_sequence_for<V...>{});
}

template <class E, class... V>
constexpr EdgeOps EdgeOpsOf<E, VertexList<V...>>::Make() {
  static_assert(sizeof...(V) <= kMaxTypedArity, "a typed edge has at most 16 vertices");
  EdgeOps ops{};
  ops.type = &kTypeInfo<E>;
  ops.traits = kEdgeTraits<E>;
  ops.value = ValueOpsOf<E>();
  ops.arity = sizeof...(V);
  ops.rows = E::kResidualDim;
  ops.vertex_types = kVertexTypes;
  ops.evaluate = &Evaluate;
  if constexpr (requires(const E& e) {
                  { e.Validate() } -> std::same_as<Status>;
                }) {
    ops.validate = [](const void* edge) -> Status {
      return static_cast<const E*>(edge)->Validate();
    };
  }
  if constexpr (requires(const E& e, const V&... vertex) {
                  { e.Depth(vertex...) } -> std::convertible_to<double>;
                }) {
    ops.depth = [](const void* edge, const double* const* states) -> double {
      return [&]<std::size_t... I>(std::index_sequence<I...>)->double {
        return static_cast<const E*>(edge)->Depth(VertexFromData<V>(states[I])...);
      }
      (std::index_sequence_for<V...>{});
    };
  }
  if constexpr (requires(const E& e) {
                  { e.SameSensor(e) } -> std::convertible_to<bool>;
                }) {
    ops.same_sensor = [](const void* edge, const void* other) -> bool {
      return static_cast<const E*>(edge)->SameSensor(*static_cast<const E*>(other));
    };
  }
  if constexpr (kEvaluatesInPacks<E>) {
    static_assert(kKnowsWhatDiffers<E>,
                  "the edge has members that are not in kLanes: it needs a SameSensor (or a "
                  "SameInRun) `bool SameSensor(const E& other) const` that compares them; one of a "
                  "base does not know the members that the edge adds");
    ops.same_in_run = ops.same_sensor;
  }
  if constexpr (requires(const E& e) { e.SameInRun(e); }) {
    ops.same_in_run = [](const void* edge, const void* other) -> bool {
      return static_cast<const E*>(edge)->SameInRun(*static_cast<const E*>(other));
    };
  }
  if constexpr (requires(const E& e) {
                  { &e.T_b_c } -> std::same_as<const Pose*>;
                }) {
    ops.extrinsic = [](const void* edge) -> const double* {
      return static_cast<const E*>(edge)->T_b_c.data;
    };
  }
  // The library's own types only: these are equal within a run in all that is not measured.
  if constexpr (kHasTwoView<E> && requires(const E& e) { e.TwoView(); }) {
    ops.two_view = [](const void* edge, TwoViewObservation* observation) {
      *observation = static_cast<const E*>(edge)->TwoView();
    };
  }
  return ops;
}

template <class E, class... V>
const TypeInfo* const EdgeOpsOf<E, VertexList<V...>>::kVertexTypes[] = {&kTypeInfo<V>...};
template <class E, class... V>
constinit const EdgeOps EdgeOpsOf<E, VertexList<V...>>::kOps = Make();

}  // namespace internal
}  // namespace glissade
