// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "glissade/base/validate.h"
#include "glissade/vertices/concept.h"

namespace glissade {

/// N plain numbers. Tangent, N: additive. A camera time offset is a VertexVector<1>.
template <int N>
struct VertexVector {
  static_assert(N >= 1);
  static constexpr int kAmbientDim = N;
  static constexpr int kTangentDim = N;
  static constexpr bool kAdditive = true;

  std::array<double, N> value{};

  double* Data() { return value.data(); }
  const double* Data() const { return value.data(); }
  void Plus(const double* delta) {
    for (int i = 0; i < N; ++i)
      Data()[i] += delta[i];
  }
  void Minus(const VertexVector& x0, double* delta) const {
    for (int i = 0; i < N; ++i)
      delta[i] = Data()[i] - x0.Data()[i];
  }
  [[nodiscard]] Status Validate() const { return ValidateFinite(Data(), N, "vector"); }
};

extern template struct internal::VertexOpsOf<VertexVector<1>>;
extern template struct internal::VertexOpsOf<VertexVector<2>>;
extern template struct internal::VertexOpsOf<VertexVector<3>>;
extern template struct internal::VertexOpsOf<VertexVector<4>>;
extern template struct internal::VertexOpsOf<VertexVector<5>>;
extern template struct internal::VertexOpsOf<VertexVector<8>>;

}  // namespace glissade
