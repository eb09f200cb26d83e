// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/vertices/pose.h"

namespace glissade {

/// Measured relative pose T_i_j (odometry, loop closure) between T_W_i and T_W_j:
///     r = [R_i' (p_j - p_i) - p_ij (m, axes of i),  Log(q_ij^-1 q_i^-1 q_j) (rad)].
struct EdgeRelativePose {
  using Vertices = VertexList<VertexPose, VertexPose>;
  static constexpr int kResidualDim = 6;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;

  Pose T_i_j;

  template <int = 0>
  bool Evaluate(const VertexPose& pose_i, const VertexPose& pose_j, Vector6& r,
                Jacobian<6, 6>* d_r_d_i, Jacobian<6, 6>* d_r_d_j) const {
    const Matrix3 R_w_i = pose_i.pose.R();
    const Vector3 p_i_j = R_w_i.transpose() * (pose_j.pose.p() - pose_i.pose.p());
    const Quaternion predicted = pose_i.pose.q().conjugate() * pose_j.pose.q();
    const Vector3 error = so3::Log(Quaternion(T_i_j.q().conjugate() * predicted));
    r.head<3>() = p_i_j - T_i_j.p();
    r.tail<3>() = error;
    if (!d_r_d_i && !d_r_d_j) return true;
    const Matrix3 Jr_inverse = so3::JrInverse(error);
    if (d_r_d_i) {
      d_r_d_i->topLeftCorner<3, 3>() = -R_w_i.transpose();
      d_r_d_i->topRightCorner<3, 3>() = so3::Hat(p_i_j);
      d_r_d_i->bottomLeftCorner<3, 3>().setZero();
      // q_i Exp(d) puts Exp(-R_ij' d) before the error; Jl^-1 is the transpose of Jr^-1.
      d_r_d_i->bottomRightCorner<3, 3>().noalias() =
          -(Jr_inverse.transpose() * T_i_j.R().transpose());
    }
    if (d_r_d_j) {
      d_r_d_j->topLeftCorner<3, 3>() = R_w_i.transpose();
      d_r_d_j->topRightCorner<3, 3>().setZero();
      d_r_d_j->bottomLeftCorner<3, 3>().setZero();
      d_r_d_j->bottomRightCorner<3, 3>() = Jr_inverse;
    }
    return true;
  }

  [[nodiscard]] Status Validate() const { return ValidatePose(T_i_j.data, "relative pose"); }
};

extern template struct internal::EdgeOpsOf<EdgeRelativePose>;

}  // namespace glissade
