// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/manifold.h>

#include "glissade/vertices/concept.h"

namespace glissade::bridge {

/// Any vertex type, through its Plus and Minus.
class VertexManifold final : public ceres::Manifold {
 public:
  explicit VertexManifold(const VertexOps& ops) : ops_(ops) {}

  int AmbientSize() const override { return ops_.ambient_dim; }
  int TangentSize() const override { return ops_.tangent_dim; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  VertexOps ops_;
};

/// A VertexPose whose position stays: tangent dtheta, q <- q Exp(dtheta).
class RotationOnlyManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 3; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace glissade::bridge
