// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/vertices/concept.h"

namespace glissade {

/// A camera of a "Bundle Adjustment in the Large" file, world to camera:
/// [rotation vector (3, rad), translation (3), focal length f (px), k1, k2].
///
/// Tangent, 9: additive in all nine, the rotation vector too, as the BAL problems define it and
/// Ceres solves them. (Unlike VertexPose, which turns by a right perturbation.)
struct VertexCameraBal {
  static constexpr int kAmbientDim = 9;
  static constexpr int kTangentDim = 9;
  static constexpr bool kAdditive = true;

  double data[9] = {};

  double* Data() { return data; }
  const double* Data() const { return data; }
  void Plus(const double* delta) {
    for (int i = 0; i < 9; ++i)
      data[i] += delta[i];
  }
  void Minus(const VertexCameraBal& x0, double* delta) const {
    for (int i = 0; i < 9; ++i)
      delta[i] = data[i] - x0.data[i];
  }
  [[nodiscard]] Status Validate() const { return ValidateFinite(data, 9, "BAL camera"); }
};

extern template struct internal::VertexOpsOf<VertexCameraBal>;

}  // namespace glissade
