// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/lie/pose.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/concept.h"

namespace glissade {

/// Pose T_W_B of body B in world W (m).
///
/// Tangent, 6: [dp, dtheta]; p <- p + dp (world axes, m), q <- q Exp(dtheta) (body axes, rad).
struct VertexPose {
  static constexpr int kAmbientDim = 7;
  static constexpr int kTangentDim = 6;
  static constexpr int kFirstEstimateSize = 7;

  Pose pose;

  double* Data() { return pose.data; }
  const double* Data() const { return pose.data; }

  template <int = 0>
  void Plus(const double* delta) {
    double* x = pose.data;
    x[0] += delta[0];
    x[1] += delta[1];
    x[2] += delta[2];
    const Quaternion d = so3::ExpQuaternion(Vector3(delta[3], delta[4], delta[5]));
    const double qx = x[3], qy = x[4], qz = x[5], qw = x[6];
    x[3] = qw * d.x() + qx * d.w() + qy * d.z() - qz * d.y();
    x[4] = qw * d.y() - qx * d.z() + qy * d.w() + qz * d.x();
    x[5] = qw * d.z() + qx * d.y() - qy * d.x() + qz * d.w();
    x[6] = qw * d.w() - qx * d.x() - qy * d.y() - qz * d.z();
    pose.Normalize();
  }

  /// delta = [p - p0, Log(q0^-1 q)].
  template <int = 0>
  void Minus(const VertexPose& x0, double* delta) const {
    for (int i = 0; i < 3; ++i)
      delta[i] = pose.data[i] - x0.pose.data[i];
    const Vector3 dtheta = so3::Log(Quaternion(x0.pose.q().conjugate() * pose.q()));
    for (int i = 0; i < 3; ++i)
      delta[3 + i] = dtheta[i];
  }

  /// Identity, and Jr^-1(Log(q0^-1 q)) for the rotation.
  void MinusJacobian(const VertexPose& x0, double* D) const;

  [[nodiscard]] Status Validate() const { return ValidatePose(pose.data, "pose"); }
};

extern template struct internal::VertexOpsOf<VertexPose>;

}  // namespace glissade
