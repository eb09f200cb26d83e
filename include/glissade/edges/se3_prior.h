// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/vertices/pose.h"

namespace glissade {

/// Prior on a pose, T_W_B ~ T_w_b: r = [p - p0 (m, world axes), Log(q0^-1 q) (rad)], that is
/// x boxminus x0 of VertexPose. Six rows, position first.
struct EdgeSE3Prior {
  using Vertices = VertexList<VertexPose>;
  static constexpr int kResidualDim = 6;
  static constexpr auto kScaleRule = ScaleRule::kPrior;

  Pose T_w_b;

  template <int = 0>
  bool Evaluate(const VertexPose& pose, Vector6& r, Jacobian<6, 6>* d_r_d_pose) const {
    pose.Minus(VertexPose{T_w_b}, r.data());
    if (d_r_d_pose) {
      // The rotation vector of the error goes into Jr^-1, not its unit axis.
      d_r_d_pose->setIdentity();
      d_r_d_pose->bottomRightCorner<3, 3>() = so3::JrInverse(r.tail<3>());
    }
    return true;
  }

  [[nodiscard]] Status Validate() const { return ValidatePose(T_w_b.data, "prior pose"); }
};

extern template struct internal::EdgeOpsOf<EdgeSE3Prior>;

}  // namespace glissade
