// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/matrix.h"
#include "glissade/base/validate.h"
#include "glissade/vertices/concept.h"

namespace glissade {

/// Point X_W of a landmark in world W (m). Tangent, 3: additive.
struct VertexPointXYZ {
  static constexpr int kAmbientDim = 3;
  static constexpr int kTangentDim = 3;
  static constexpr int kFirstEstimateSize = 3;
  static constexpr bool kEliminated = true;
  static constexpr bool kAdditive = true;

  double data[3] = {0.0, 0.0, 0.0};

  VertexPointXYZ() = default;
  explicit VertexPointXYZ(const Vector3& p_w) : data{p_w[0], p_w[1], p_w[2]} {}
  VertexPointXYZ(double x, double y, double z) : data{x, y, z} {}

  [[nodiscard]] Eigen::Map<const Vector3> p() const { return Eigen::Map<const Vector3>(data); }
  [[nodiscard]] Eigen::Map<Vector3> p() { return Eigen::Map<Vector3>(data); }

  double* Data() { return data; }
  const double* Data() const { return data; }
  void Plus(const double* delta) {
    for (int i = 0; i < 3; ++i)
      data[i] += delta[i];
  }
  void Minus(const VertexPointXYZ& x0, double* delta) const {
    for (int i = 0; i < 3; ++i)
      delta[i] = data[i] - x0.data[i];
  }
  [[nodiscard]] Status Validate() const { return ValidateFinite(data, 3, "point"); }
};

extern template struct internal::VertexOpsOf<VertexPointXYZ>;

}  // namespace glissade
