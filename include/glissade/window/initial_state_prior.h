// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/base/validate.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"

namespace glissade {

/// What is believed of a first state: tilt, speed, biases. Position and heading are left open, and
/// the residual does not see them at all, wherever it is linearized.
///
/// Vertices: T_W_B, [v, b_a, b_g]. With u = R' e_z, the vertical in the body, and B two unit
/// vectors perpendicular to u at the prior's pose,
///     r = [ B' u (2), R' v - R_0' v_0 (3), b_a - b_a0 (3), b_g - b_g0 (3) ].
struct EdgeInitialState {
  using Vertices = VertexList<VertexPose, VertexSpeedBias>;
  static constexpr int kResidualDim = 11;

  Pose T_w_b;                  ///< only its tilt matters
  VertexSpeedBias speed_bias;  ///< v_0 in the world, at T_w_b

  template <int = 0>
  bool Evaluate(const VertexPose& pose, const VertexSpeedBias& state, Vector<11>& r,
                Jacobian<11, 6>* d_r_d_pose, Jacobian<11, 9>* d_r_d_state) const {
    const Matrix3 R = pose.pose.R(), R0 = T_w_b.R();
    const Vector3 up = R.row(2).transpose(), up0 = R0.row(2).transpose();
    const Vector3 v(state.data[0], state.data[1], state.data[2]);
    const Vector3 v0(speed_bias.data[0], speed_bias.data[1], speed_bias.data[2]);
    const Matrix<3, 2> B = Perpendicular(up0);
    const Vector3 v_b = R.transpose() * v;
    r.head<2>() = B.transpose() * up;
    r.segment<3>(2) = v_b - R0.transpose() * v0;
    for (int i = 0; i < 6; ++i)
      r[5 + i] = state.data[3 + i] - speed_bias.data[3 + i];
    if (d_r_d_pose) {
      d_r_d_pose->setZero();
      d_r_d_pose->block<2, 3>(0, 3) = B.transpose() * so3::Hat(up);
      d_r_d_pose->block<3, 3>(2, 3) = so3::Hat(v_b);
    }
    if (d_r_d_state) {
      d_r_d_state->setZero();
      d_r_d_state->block<3, 3>(2, 0) = R.transpose();
      d_r_d_state->block<6, 6>(5, 3).setIdentity();
    }
    return true;
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidatePose(T_w_b.data, "initial pose"); !s.ok()) return s;
    return speed_bias.Validate();
  }

  /// B of a vertical u.
  template <int = 0>
  static Matrix<3, 2> Perpendicular(const Vector3& u) {
    // The axis that u has least of, made perpendicular.
    int least = 0;
    for (int i = 1; i < 3; ++i) {
      if (std::abs(u[i]) < std::abs(u[least])) least = i;
    }
    Vector3 a = -u[least] * u;
    a[least] += 1.0;
    a /= a.norm();
    const Vector3 b(u[1] * a[2] - u[2] * a[1], u[2] * a[0] - u[0] * a[2],
                    u[0] * a[1] - u[1] * a[0]);
    Matrix<3, 2> B;
    B.col(0) = a;
    B.col(1) = b;
    return B;
  }
};

}  // namespace glissade
