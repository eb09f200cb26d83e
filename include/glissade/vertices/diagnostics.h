// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/vertices/concept.h"

/// \file
/// What a compiler says where a vertex type is wrong; see edges/diagnostics.h.
namespace glissade::internal {

template <class V>
constexpr void ExplainVertex() {
  if constexpr (!VertexHasDimensions<V>) {
    static_assert(VertexHasDimensions<V>,
                  "a vertex type declares `static constexpr int kAmbientDim, kTangentDim`, "
                  "kAmbientDim >= kTangentDim >= 1");
  } else if constexpr (!VertexHasData<V>) {
    static_assert(VertexHasData<V>,
                  "a vertex type has `double* Data()` and `const double* Data() const`");
  } else if constexpr (!VertexHasManifold<V>) {
    static_assert(VertexHasManifold<V>,
                  "a vertex type has `void Plus(const double* delta)` and "
                  "`void Minus(const V& x0, double* delta) const`");
  } else {
    static_assert(std::copyable<V> && std::default_initializable<V>,
                  "a vertex type is a plain value: copyable and default-constructible");
  }
}

}  // namespace glissade::internal
