// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/matrix.h"
#include "glissade/base/validate.h"
#include "glissade/vertices/concept.h"

namespace glissade {

/// [v_W, b_a, b_g]: velocity of the body in world axes (m/s), accelerometer bias (m/s^2) and
/// gyroscope bias (rad/s) in body axes. Tangent, 9: additive.
struct VertexSpeedBias {
  static constexpr int kAmbientDim = 9;
  static constexpr int kTangentDim = 9;
  static constexpr bool kAdditive = true;
  static constexpr int kFirstEstimateSize = 3;  // v; biases do not move with the gauge

  double data[9] = {};

  VertexSpeedBias() = default;
  VertexSpeedBias(const Vector3& v_w, const Vector3& ba, const Vector3& bg)
      : data{v_w[0], v_w[1], v_w[2], ba[0], ba[1], ba[2], bg[0], bg[1], bg[2]} {}

  [[nodiscard]] Eigen::Map<const Vector3> v() const { return Eigen::Map<const Vector3>(data); }
  [[nodiscard]] Eigen::Map<const Vector3> ba() const { return Eigen::Map<const Vector3>(data + 3); }
  [[nodiscard]] Eigen::Map<const Vector3> bg() const { return Eigen::Map<const Vector3>(data + 6); }
  [[nodiscard]] Eigen::Map<Vector3> v() { return Eigen::Map<Vector3>(data); }
  [[nodiscard]] Eigen::Map<Vector3> ba() { return Eigen::Map<Vector3>(data + 3); }
  [[nodiscard]] Eigen::Map<Vector3> bg() { return Eigen::Map<Vector3>(data + 6); }

  double* Data() { return data; }
  const double* Data() const { return data; }
  void Plus(const double* delta) {
    for (int i = 0; i < 9; ++i)
      data[i] += delta[i];
  }
  void Minus(const VertexSpeedBias& x0, double* delta) const {
    for (int i = 0; i < 9; ++i)
      delta[i] = data[i] - x0.data[i];
  }
  [[nodiscard]] Status Validate() const { return ValidateFinite(data, 9, "speed and biases"); }
};

extern template struct internal::VertexOpsOf<VertexSpeedBias>;

}  // namespace glissade
