// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "glissade/base/handle.h"
#include "glissade/base/status.h"
#include "glissade/base/validate.h"
#include "glissade/base/value_array.h"

/// \file
/// What a type must offer to be a vertex of the graph. A vertex is a plain value:
///
///     struct VertexPlane {
///       static constexpr int kAmbientDim = 4;        // doubles that hold the state
///       static constexpr int kTangentDim = 3;        // degrees of freedom
///       static constexpr bool kEliminated = false;   // optional: true for landmark types
///       double* Data();                              // kAmbientDim contiguous doubles:
///       const double* Data() const;                  //   the whole state
///       void Plus(const double* delta);              // x <- x boxplus delta (kTangentDim)
///       void Minus(const VertexPlane& x0, double* delta) const;  // delta = x boxminus x0
///       Status Validate() const;                     // optional: refuse an impossible state
///       static constexpr int kFirstEstimateSize = 4; // optional: so many of the leading numbers
///                                                    //   of the state move with the gauge
///       static constexpr bool kAdditive = false;     // optional, true: x boxplus d is x + d,
///                                                    //   x boxminus x0 is x - x0
///       void MinusJacobian(const VertexPlane& x0, double* D) const;  // optional: D =
///                                 //   d((x boxplus d) boxminus x0)/dd at d = 0, row-major
///                                 //   kTangentDim x kTangentDim; else by differences
///     };
///
/// Axioms (CheckVertexAxioms in testing.h, which checks the two last as well): (x boxplus 0) = x,
/// x boxplus (y boxminus x) = y, (x boxplus d) boxminus x = d for small d.
namespace glissade {

// clang-format 14 takes concepts apart.
// clang-format off
template <class V>
concept VertexHasDimensions = requires {
  { V::kAmbientDim } -> std::convertible_to<int>;
  { V::kTangentDim } -> std::convertible_to<int>;
} && (V::kTangentDim >= 1) && (V::kAmbientDim >= V::kTangentDim);

template <class V>
concept VertexHasData = requires(V v, const V cv) {
  { v.Data() } -> std::same_as<double*>;
  { cv.Data() } -> std::same_as<const double*>;
};

template <class V>
concept VertexHasManifold = requires(V v, const V cv, const double* in, double* out) {
  v.Plus(in);
  cv.Minus(cv, out);
};

template <class V>
concept VertexType = std::copyable<V> && std::default_initializable<V> && VertexHasDimensions<V> &&
                     VertexHasData<V> && VertexHasManifold<V>;
// clang-format on

/// True for landmark types: eliminated from the normal equations one by one (Schur complement).
template <class V>
inline constexpr bool kIsEliminated = [] {
  if constexpr (requires { V::kEliminated; }) {
    static_assert(!V::kEliminated || V::kTangentDim <= 4,
                  "an eliminated vertex type has a tangent of 1 to 4 dimensions");
    return bool(V::kEliminated);
  } else {
    return false;
  }
}();

/// kFirstEstimateSize of a vertex type that declares it, else 0.
template <class V>
inline constexpr int kFirstEstimateSizeOf = [] {
  if constexpr (requires { V::kFirstEstimateSize; }) {
    static_assert(0 <= V::kFirstEstimateSize && V::kFirstEstimateSize <= V::kAmbientDim);
    static_assert(V::kAmbientDim <= 16, "at most 16 numbers for a type with first estimates");
    return int(V::kFirstEstimateSize);
  } else {
    return 0;
  }
}();

/// Whether a vertex type declares that boxplus is a sum.
template <class V>
inline constexpr bool kIsAdditive = [] {
  if constexpr (requires { V::kAdditive; }) {
    static_assert(!V::kAdditive || V::kAmbientDim == V::kTangentDim,
                  "a sum has as many numbers as its terms");
    return bool(V::kAdditive);
  } else {
    return false;
  }
}();

/// A vertex type at run time: its name, dimensions and manifold, as functions on raw states.
struct VertexOps {
  const TypeInfo* type;
  int ambient_dim;
  int tangent_dim;
  bool eliminated;
  /// How many of the leading numbers of the state a linearization point replaces where first
  /// estimates are kept (graph/first_estimates.h): those that move with the gauge.
  int first_estimate_size;
  bool additive;  ///< boxplus is a sum
  void (*plus)(const double* x, const double* delta, double* x_plus_delta);
  void (*minus)(const double* x, const double* x0, double* delta);
  /// Null where the type has none (of an additive one it is the identity).
  void (*minus_jacobian)(const double* x, const double* x0, double* D);
  /// Refuses a state that is not finite, or that the type's Validate() refuses.
  Status (*validate)(const double* x);

  // Of values, as pools keep them.
  internal::ValueOps value;
  const double* (*data)(const void* vertex);  ///< Data()
  /// Validate(); null where the type has none.
  Status (*validate_value)(const void* vertex);
  /// vertex k of `count` <- vertex k boxplus step[offset[k]], where that is not negative.
  void (*plus_all)(void* vertices, const double* step, const std::int32_t* offset, int count);
};

namespace internal {

/// Runs the optional Validate() of a vertex, edge or loss.
template <class T>
Status ValidateIfPossible(const T& value) {
  if constexpr (requires {
                  { value.Validate() } -> std::same_as<Status>;
                }) {
    return value.Validate();
  } else {
    return {};
  }
}

template <VertexType V>
V VertexFromData(const double* x) {
  V v;
  std::memcpy(v.Data(), x, sizeof(double) * V::kAmbientDim);
  return v;
}

/// Its own: what a type inherits need not fit the Minus() it has overridden.
template <class V>
concept VertexHasMinusJacobian = requires {
  static_cast<void (V::*)(const V&, double*) const>(&V::MinusJacobian);
};

/// The VertexOps of V. Those of the library's own types are compiled in the library alone: their
/// headers declare them `extern template`.
template <class V>
struct VertexOpsOf {
  static const VertexOps kOps;

  static void Plus(const double* x, const double* delta, double* out);
  static void Minus(const double* x, const double* x0, double* delta);
  static Status Validate(const double* x);
  static const double* Data(const void* vertex);
  static void PlusAll(void* vertices, const double* step, const std::int32_t* offset, int count);
  static constexpr VertexOps Make();
};

template <class V>
void VertexOpsOf<V>::Plus(const double* x, const double* delta, double* out) {
  V v = VertexFromData<V>(x);
  v.Plus(delta);
  std::memcpy(out, v.Data(), sizeof(double) * V::kAmbientDim);
}

template <class V>
void VertexOpsOf<V>::Minus(const double* x, const double* x0, double* delta) {
  VertexFromData<V>(x).Minus(VertexFromData<V>(x0), delta);
}

template <class V>
Status VertexOpsOf<V>::Validate(const double* x) {
  if (Status s = ValidateFinite(x, V::kAmbientDim, kTypeInfo<V>.name); !s.ok()) return s;
  return ValidateIfPossible(VertexFromData<V>(x));
}

template <class V>
const double* VertexOpsOf<V>::Data(const void* vertex) {
  return static_cast<const V*>(vertex)->Data();
}

template <class V>
void VertexOpsOf<V>::PlusAll(void* vertices, const double* step, const std::int32_t* offset,
                             int count) {
  for (int k = 0; k < count; ++k) {
    if (offset[k] >= 0) static_cast<V*>(vertices)[k].Plus(step + offset[k]);
  }
}

template <class V>
constexpr VertexOps VertexOpsOf<V>::Make() {
  VertexOps ops{};
  ops.type = &kTypeInfo<V>;
  ops.ambient_dim = V::kAmbientDim;
  ops.tangent_dim = V::kTangentDim;
  ops.eliminated = kIsEliminated<V>;
  ops.first_estimate_size = kFirstEstimateSizeOf<V>;
  ops.additive = kIsAdditive<V>;
  ops.plus = &Plus;
  ops.minus = &Minus;
  if constexpr (VertexHasMinusJacobian<V>) {
    ops.minus_jacobian = [](const double* x, const double* x0, double* D) {
      VertexFromData<V>(x).MinusJacobian(VertexFromData<V>(x0), D);
    };
  }
  ops.validate = &Validate;
  ops.value = ValueOpsOf<V>();
  ops.data = &Data;
  if constexpr (requires(const V& v) {
                  { v.Validate() } -> std::same_as<Status>;
                }) {
    ops.validate_value = [](const void* vertex) -> Status {
      return static_cast<const V*>(vertex)->Validate();
    };
  }
  ops.plus_all = &PlusAll;
  return ops;
}

template <class V>
constinit const VertexOps VertexOpsOf<V>::kOps = Make();

}  // namespace internal

template <VertexType V>
inline constexpr const VertexOps& kVertexOps = internal::VertexOpsOf<V>::kOps;

/// A vertex as a dynamic edge sees it: its type and where its state lies (ambient_dim doubles).
struct VertexRef {
  const VertexOps* ops = nullptr;
  const double* data = nullptr;
};

}  // namespace glissade
