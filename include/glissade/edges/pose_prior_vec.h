// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/lie/quaternion_error.h"
#include "glissade/vertices/pose.h"

namespace glissade {

/// Prior on a pose as VIOWIN files write it: r = [p - p0 (m, world axes), 2 vec(q0^-1 q)], the sign
/// of the quaternion chosen so that w >= 0. Six rows. Differs from EdgeSE3Prior in second order.
struct EdgePosePriorVec {
  using Vertices = VertexList<VertexPose>;
  static constexpr int kResidualDim = 6;
  static constexpr auto kScaleRule = ScaleRule::kPrior;

  Pose T_w_b;

  template <int = 0>
  bool Evaluate(const VertexPose& pose, Vector6& r, Jacobian<6, 6>* d_r_d_pose) const {
    const Quaternion error = WithPositiveW(T_w_b.q().conjugate() * pose.pose.q());
    r.head<3>() = pose.pose.p() - T_w_b.p();
    r.tail<3>() = 2.0 * error.vec();
    if (d_r_d_pose) {
      d_r_d_pose->setIdentity();
      d_r_d_pose->bottomRightCorner<3, 3>() = TwoVecRightJacobian(error);
    }
    return true;
  }

  [[nodiscard]] Status Validate() const { return ValidatePose(T_w_b.data, "prior pose"); }
};

extern template struct internal::EdgeOpsOf<EdgePosePriorVec>;

}  // namespace glissade
