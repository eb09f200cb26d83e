// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/edges/edge_ops.h"
#include "glissade/edges/preintegrated_imu.h"
#include "glissade/lie/quaternion_error.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"

namespace glissade {

/// Preintegrated IMU measurements between frames i and j.
///
/// Vertices: T_W_Bi, [v ba bg]_i, T_W_Bj, [v ba bg]_j. Fifteen rows, order p, theta, v, ba, bg;
/// with dba = ba_i - ba_lin, dbg = bg_i - bg_lin:
///     e_p     = R_i' (p_j - p_i - v_i dt - g dt^2 / 2) - (dp + dp_dba dba + dp_dbg dbg)      (m)
///     e_theta = 2 vec((dq Exp(dq_dbg dbg))^-1 q_i^-1 q_j), its sign chosen so that w >= 0    (rad)
///     e_v     = R_i' (v_j - v_i - g dt) - (dv + dv_dba dba + dv_dbg dbg)                     (m/s)
///     e_ba    = ba_j - ba_i,   e_bg = bg_j - bg_i                                (m/s^2, rad/s)
/// Source: T. Qin et al., "VINS-Mono" (TRO 2018), Eq. (16), in the order above; the preintegration
/// is that of Forster et al. The weight is given with the edge as square-root information (15 x
/// 15).
struct EdgeImu {
  using Vertices = VertexList<VertexPose, VertexSpeedBias, VertexPose, VertexSpeedBias>;
  static constexpr int kResidualDim = 15;

  PreintegratedImu imu;
  /// Gravity acceleration in the world (m/s^2).
  Vector3 gravity = Vector3(0.0, 0.0, -9.81);

  template <int = 0>
  bool Evaluate(const VertexPose& pose_i, const VertexSpeedBias& sb_i, const VertexPose& pose_j,
                const VertexSpeedBias& sb_j, Vector<15>& r, Jacobian<15, 6>* d_r_d_pose_i,
                Jacobian<15, 9>* d_r_d_sb_i, Jacobian<15, 6>* d_r_d_pose_j,
                Jacobian<15, 9>* d_r_d_sb_j) const {
    const double dt = imu.dt;
    const Matrix3 R_i_w = pose_i.pose.R().transpose();
    const Vector3 dba = sb_i.ba() - imu.ba_lin;
    const Vector3 dbg = sb_i.bg() - imu.bg_lin;
    // What the states say about the quantities that were measured, in axes of body i.
    const Vector3 p_i =
        R_i_w * (pose_j.pose.p() - pose_i.pose.p() - dt * (sb_i.v() + 0.5 * dt * gravity));
    const Vector3 v_i = R_i_w * (sb_j.v() - sb_i.v() - dt * gravity);
    const Vector3 phi = imu.dq_dbg * dbg;
    const Quaternion corrected = imu.dq * so3::ExpQuaternion(phi);
    const Quaternion error = WithPositiveW(
        corrected.conjugate() * Quaternion(pose_i.pose.q().conjugate() * pose_j.pose.q()));

    r.segment<3>(0) = p_i - imu.dp - imu.dp_dba * dba - imu.dp_dbg * dbg;
    r.segment<3>(3) = 2.0 * error.vec();
    r.segment<3>(6) = v_i - imu.dv - imu.dv_dba * dba - imu.dv_dbg * dbg;
    r.segment<3>(9) = sb_j.ba() - sb_i.ba();
    r.segment<3>(12) = sb_j.bg() - sb_i.bg();

    const bool wants_i = d_r_d_pose_i || d_r_d_sb_i;
    if (wants_i) {
      const Matrix3 left = TwoVecLeftJacobian(error);
      if (d_r_d_pose_i) {
        d_r_d_pose_i->setZero();
        d_r_d_pose_i->block<3, 3>(0, 0) = -R_i_w;
        d_r_d_pose_i->block<3, 3>(0, 3) = so3::Hat(p_i);
        // q_i Exp(d) puts Exp(-d) between the corrected measurement and q_i^-1 q_j.
        const Matrix3 R_corrected = RotationMatrix(corrected.coeffs().data());
        d_r_d_pose_i->block<3, 3>(3, 3).noalias() = -(left * R_corrected.transpose());
        d_r_d_pose_i->block<3, 3>(6, 3) = so3::Hat(v_i);
      }
      if (d_r_d_sb_i) {
        d_r_d_sb_i->setZero();
        d_r_d_sb_i->block<3, 3>(0, 0) = -dt * R_i_w;
        d_r_d_sb_i->block<3, 3>(0, 3) = -imu.dp_dba;
        d_r_d_sb_i->block<3, 3>(0, 6) = -imu.dp_dbg;
        const Matrix3 d_phi = so3::Jr(phi) * imu.dq_dbg;
        d_r_d_sb_i->block<3, 3>(3, 6).noalias() = -(left * d_phi);
        d_r_d_sb_i->block<3, 3>(6, 0) = -R_i_w;
        d_r_d_sb_i->block<3, 3>(6, 3) = -imu.dv_dba;
        d_r_d_sb_i->block<3, 3>(6, 6) = -imu.dv_dbg;
        for (int k = 0; k < 6; ++k)
          (*d_r_d_sb_i)(9 + k, 3 + k) = -1.0;
      }
    }
    if (d_r_d_pose_j) {
      d_r_d_pose_j->setZero();
      d_r_d_pose_j->block<3, 3>(0, 0) = R_i_w;
      d_r_d_pose_j->block<3, 3>(3, 3) = TwoVecRightJacobian(error);
    }
    if (d_r_d_sb_j) {
      d_r_d_sb_j->setZero();
      d_r_d_sb_j->block<3, 3>(6, 0) = R_i_w;
      for (int k = 0; k < 6; ++k)
        (*d_r_d_sb_j)(9 + k, 3 + k) = 1.0;
    }
    return true;
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidateFinite(gravity.data(), 3, "gravity"); !s.ok()) return s;
    return imu.Validate();
  }
};

extern template struct internal::EdgeOpsOf<EdgeImu>;

}  // namespace glissade
