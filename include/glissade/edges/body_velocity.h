// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"

namespace glissade {

/// A measured velocity of the body in its own axes: standing still (zero), wheels, a Doppler log.
///
/// Vertices: T_W_B, [v, b_a, b_g];  r = R' v - v_b (m/s). Nothing of it depends on the heading, so
/// that the gauge stays free wherever it is linearized; a prior on v in the world would hold it.
struct EdgeBodyVelocity {
  using Vertices = VertexList<VertexPose, VertexSpeedBias>;
  static constexpr int kResidualDim = 3;

  Vector3 v_b = Vector3::Zero();  ///< m/s

  template <int = 0>
  bool Evaluate(const VertexPose& pose, const VertexSpeedBias& state, Vector3& r,
                Jacobian<3, 6>* d_r_d_pose, Jacobian<3, 9>* d_r_d_state) const {
    const Matrix3 R_b_w = pose.pose.R().transpose();
    const Vector3 v = R_b_w * state.v();
    r = v - v_b;
    if (d_r_d_pose) {
      d_r_d_pose->setZero();
      d_r_d_pose->block<3, 3>(0, 3) = so3::Hat(v);
    }
    if (d_r_d_state) {
      d_r_d_state->setZero();
      d_r_d_state->block<3, 3>(0, 0) = R_b_w;
    }
    return true;
  }

  [[nodiscard]] Status Validate() const { return ValidateFinite(v_b.data(), 3, "body velocity"); }
};

}  // namespace glissade
