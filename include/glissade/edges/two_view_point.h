// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "glissade/base/pack.h"
#include "glissade/cameras/concept.h"
#include "glissade/edges/lanes.h"
#include "glissade/vertices/pose_view.h"

/// \file
/// The geometry shared by the observation edges of inverse-depth landmarks.
namespace glissade::internal {

/// An inverse-depth landmark of host frame i, seen from the camera of target frame j. Everything is
/// multiplied through by rho, so that it exists for points at infinity (rho = 0) too; a projection
/// does not see the factor.
template <class T>
struct TwoViewPoint {
  using Frame = View<VertexPose, T>;
  const Frame& T_w_i;
  const Frame& T_w_j;
  T rho;
  const Frame& T_bi_c;  ///< extrinsics (camera to body) of the host's and the target's camera
  const Frame& T_bj_c;
  Vec<T, 3> bearing;  ///< (x/z, y/z, 1), host camera
  Vec<T, 3> h;        ///< rho * point in body i
  Vec<T, 3> y;        ///< rho * point in body j
  Vec<T, 3> q;        ///< rho * point in the target camera

  TwoViewPoint(const Frame& i, const Frame& j, const T& inverse_depth, const Vec<T, 2>& uv_host,
               const Frame& host_camera, const Frame& target_camera)
      : T_w_i(i),
        T_w_j(j),
        rho(inverse_depth),
        T_bi_c(host_camera),
        T_bj_c(target_camera),
        bearing{{uv_host[0], uv_host[1], T(1.0)}} {
    h = T_bi_c.R * bearing + rho * T_bi_c.p;
    y = TransposeTimes(T_w_j.R, T_w_i.R * h + rho * (T_w_i.p - T_w_j.p));
    q = TransposeTimes(T_bj_c.R, y - rho * T_bj_c.p);
  }
};

/// uv of the direction rho * p_c / rho; false where there is none or where it is not finite.
template <class T, CameraModel Camera>
bool ProjectScaled(const Camera& camera, const Vec<T, 3>& scaled, const T& rho, Vec<T, 2>& uv,
                   Mat<T, 2, 3>* d_uv_d_scaled) {
  const T sign = Select(rho < T(0.0), T(-1.0), T(1.0));
  if (!ProjectLanes(camera, sign * scaled, uv, d_uv_d_scaled)) return false;
  if (d_uv_d_scaled != nullptr) *d_uv_d_scaled = sign * *d_uv_d_scaled;
  return HasValue(uv);
}

/// The chain rule from d uv / d(rho p_c) to the tangents, by rows: one cross product each instead
/// of a product with a 3x3 matrix.
template <class T>
struct TwoViewDerivatives {
  const TwoViewPoint<T>& point;
  const Mat<T, 2, 3>& d_c;  ///< d r / d(rho * point in the target camera)
  Mat<T, 2, 3> d_bj;        ///< d r / d(... in body j)
  Mat<T, 2, 3> d_w;         ///< d r / d(... in world axes)
  Mat<T, 2, 3> d_bi;        ///< d r / d(... in body i)

  TwoViewDerivatives(const TwoViewPoint<T>& p, const Mat<T, 2, 3>& d_r_d_c)
      : point(p), d_c(d_r_d_c) {
    d_bj = d_c * p.T_bj_c.R.Transpose();
    d_w = d_bj * p.T_w_j.R.Transpose();
    d_bi = d_w * p.T_w_i.R;
  }

  void Host(Mat<T, 2, 6>& d_r_d_pose_i) const {
    d_r_d_pose_i.Set(0, 0, point.rho * d_w);
    for (int row = 0; row < 2; ++row)
      d_r_d_pose_i.Set(row, 3, Cross(point.h, d_bi.Row(row)));
  }

  void Target(Mat<T, 2, 6>& d_r_d_pose_j) const {
    d_r_d_pose_j.Set(0, 0, -(point.rho * d_w));
    for (int row = 0; row < 2; ++row)
      d_r_d_pose_j.Set(row, 3, Cross(d_bj.Row(row), point.y));
  }

  /// Through what rho multiplies: d(rho * point in camera j) / d rho.
  void InverseDepth(Mat<T, 2, 1>& d_r_d_rho) const {
    d_r_d_rho =
        d_bi * point.T_bi_c.p + d_w * (point.T_w_i.p - point.T_w_j.p) - d_bj * point.T_bj_c.p;
  }

  /// With respect to the tangent of T_b_c where host and target are seen by the same camera: it
  /// brings the bearing into body i and the point out of body j.
  void SharedExtrinsic(Mat<T, 2, 6>& d_r_d_extrinsic) const {
    const Mat<T, 2, 3> d_ci = d_bi * point.T_bi_c.R;
    d_r_d_extrinsic.Set(0, 0, point.rho * (d_bi - d_bj));
    for (int row = 0; row < 2; ++row) {
      d_r_d_extrinsic.Set(row, 3,
                          Cross(point.bearing, d_ci.Row(row)) + Cross(d_c.Row(row), point.q));
    }
  }

  /// Along a change of uv_host.
  [[nodiscard]] Vec<T, 2> HostObservation(const Vec<T, 2>& d_uv_host) const {
    const Vec<T, 3> d_bearing = {{d_uv_host[0], d_uv_host[1], T(0.0)}};
    return d_bi * (point.T_bi_c.R * d_bearing);
  }
};

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

/// The same from the states of an edge.
inline double TwoViewDepth(const Pose& host, const Pose& target, double rho, const Vector2& uv_host,
                           const Pose& T_b_host, const Pose& T_b_target) {
  const auto i = ViewOf<double>(host), j = ViewOf<double>(target);
  const auto host_camera = ViewOf<double>(T_b_host), target_camera = ViewOf<double>(T_b_target);
  const TwoViewPoint<double> x(i, j, rho, {{uv_host[0], uv_host[1]}}, host_camera, target_camera);
  return TwoViewDepth(x.q[2], rho);
}

}  // namespace glissade::internal
