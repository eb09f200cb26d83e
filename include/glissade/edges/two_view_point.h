// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "glissade/base/matrix.h"
#include "glissade/cameras/concept.h"
#include "glissade/lie/pose.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/pose.h"

/// \file
/// The geometry shared by the observation edges of inverse-depth landmarks.
namespace glissade::internal {

/// An inverse-depth landmark of host frame i, seen from the camera of target frame j. Everything is
/// multiplied through by rho, so that it exists for points at infinity (rho = 0) too; a projection
/// does not see the factor.
/// A template only so that a translation unit that does not evaluate such edges does not compile
/// it.
template <int = 0>
struct TwoViewPointOf {
  double rho;
  Matrix3 R_w_i, R_w_j, R_bi_c, R_bj_c;
  Vector3 bearing;  ///< (x/z, y/z, 1), host camera
  Vector3 h;        ///< rho * point in body i
  Vector3 y;        ///< rho * point in body j
  Vector3 q;        ///< rho * point in the target camera
  Vector3 t_bi_c, t_bj_c;

  /// T_bi_c, T_bj_c: extrinsics (camera to body) of the host's and the target's camera.
  TwoViewPointOf(const Pose& T_w_i, const Pose& T_w_j, double inverse_depth, const Vector2& uv_host,
                 const Pose& T_bi_c, const Pose& T_bj_c)
      : rho(inverse_depth),
        R_w_i(T_w_i.R()),
        R_w_j(T_w_j.R()),
        R_bi_c(T_bi_c.R()),
        R_bj_c(T_bj_c.R()),
        bearing(uv_host[0], uv_host[1], 1.0),
        t_bi_c(T_bi_c.p()),
        t_bj_c(T_bj_c.p()) {
    h.noalias() = R_bi_c * bearing + rho * t_bi_c;
    const Vector3 w = R_w_i * h + rho * (T_w_i.p() - T_w_j.p());
    y.noalias() = R_w_j.transpose() * w;
    q.noalias() = R_bj_c.transpose() * (y - rho * t_bj_c);
  }
};

using TwoViewPoint = TwoViewPointOf<>;

/// uv of the direction rho * p_c / rho; false where there is none or where it is not finite.
template <CameraModel Camera>
bool ProjectScaled(const Camera& camera, const Vector3& scaled, double rho, Vector2& uv,
                   Matrix<2, 3>* d_uv_d_scaled) {
  const double sign = rho < 0.0 ? -1.0 : 1.0;
  if (!camera.Project(sign * scaled, uv, d_uv_d_scaled)) return false;
  if (d_uv_d_scaled != nullptr) *d_uv_d_scaled *= sign;
  return std::isfinite(uv[0] + uv[1]);
}

/// The chain rule from d uv / d(rho p_c) to the tangents, by rows: one cross product each instead
/// of a product with a 3x3 matrix.
template <int = 0>
struct TwoViewDerivativesOf {
  const TwoViewPoint& point;
  const Matrix<2, 3>& d_c;  ///< d r / d(rho * point in the target camera)
  Matrix<2, 3> d_bj;        ///< d r / d(... in body j)
  Matrix<2, 3> d_w;         ///< d r / d(... in world axes)
  Matrix<2, 3> d_bi;        ///< d r / d(... in body i)

  TwoViewDerivativesOf(const TwoViewPoint& p, const Matrix<2, 3>& d_r_d_c)
      : point(p), d_c(d_r_d_c) {
    d_bj.noalias() = d_c * p.R_bj_c.transpose();
    d_w.noalias() = d_bj * p.R_w_j.transpose();
    d_bi.noalias() = d_w * p.R_w_i;
  }

  void Host(Jacobian<2, 6>& d_r_d_pose_i) const {
    for (int row = 0; row < 2; ++row) {
      d_r_d_pose_i.row(row).head<3>() = point.rho * d_w.row(row);
      d_r_d_pose_i.row(row).tail<3>() = point.h.cross(Vector3(d_bi.row(row))).transpose();
    }
  }

  void Target(Jacobian<2, 6>& d_r_d_pose_j) const {
    for (int row = 0; row < 2; ++row) {
      d_r_d_pose_j.row(row).head<3>() = -point.rho * d_w.row(row);
      d_r_d_pose_j.row(row).tail<3>() = Vector3(d_bj.row(row)).cross(point.y).transpose();
    }
  }

  /// T_w_i and T_w_j once more for what rho multiplies: d(rho * point in camera j) / d rho.
  void InverseDepth(const Pose& T_w_i, const Pose& T_w_j, Jacobian<2, 1>& d_r_d_rho) const {
    d_r_d_rho.noalias() = d_bi * point.t_bi_c + d_w * (T_w_i.p() - T_w_j.p());
    d_r_d_rho.noalias() -= d_bj * point.t_bj_c;
  }

  /// With respect to the tangent of T_b_c where host and target are seen by the same camera: it
  /// brings the bearing into body i and the point out of body j.
  void SharedExtrinsic(Jacobian<2, 6>& d_r_d_extrinsic) const {
    const Matrix<2, 3> d_ci = d_bi * point.R_bi_c;
    for (int row = 0; row < 2; ++row) {
      d_r_d_extrinsic.row(row).head<3>() = point.rho * (d_bi.row(row) - d_bj.row(row));
      d_r_d_extrinsic.row(row).tail<3>() =
          (point.bearing.cross(Vector3(d_ci.row(row))) + Vector3(d_c.row(row)).cross(point.q))
              .transpose();
    }
  }

  /// With respect to uv_host.
  void HostObservation(Matrix2& d_r_d_uv_host) const {
    d_r_d_uv_host.noalias() = d_bi * point.R_bi_c.leftCols<2>();
  }
};

using TwoViewDerivatives = TwoViewDerivativesOf<>;

/// Depth as the inverse-depth edges report it: z in the target camera, or, for a landmark that lies
/// behind its host (rho < 0), the smaller of that and the depth 1/rho in the host. Positive exactly
/// if the point is in front of both. Infinite at rho = 0.
inline double TwoViewDepth(double z_scaled, double rho) {
  if (rho == 0.0) {
    const double infinity = std::numeric_limits<double>::infinity();
    return z_scaled > 0.0 ? infinity : -infinity;
  }
  const double z = z_scaled / rho;
  return rho > 0.0 ? z : std::fmin(z, 1.0 / rho);
}

}  // namespace glissade::internal
