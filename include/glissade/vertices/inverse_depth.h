// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/vertices/concept.h"

namespace glissade {

/// Inverse depth of a landmark: rho = 1/z (1/m) in its host camera, along the host bearing
/// (x/z, y/z, 1). Zero is a point at infinity. Tangent, 1: additive.
struct VertexInverseDepth {
  static constexpr int kAmbientDim = 1;
  static constexpr int kTangentDim = 1;
  static constexpr bool kEliminated = true;
  static constexpr bool kAdditive = true;

  double rho = 0.0;

  double* Data() { return &rho; }
  const double* Data() const { return &rho; }
  void Plus(const double* delta) { rho += delta[0]; }
  void Minus(const VertexInverseDepth& x0, double* delta) const { delta[0] = rho - x0.rho; }
  [[nodiscard]] Status Validate() const { return ValidateFinite(&rho, 1, "inverse depth"); }
};

extern template struct internal::VertexOpsOf<VertexInverseDepth>;

}  // namespace glissade
