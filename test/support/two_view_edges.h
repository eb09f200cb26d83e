// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/edges/lanes.h"
#include "glissade/edges/reprojection.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/pose_view.h"

/// \file
/// EdgeReprojection as a user would write it, in the three forms that an edge may have
/// (docs/own_edges.md). Each says by which relative pose it knows its poses.
namespace glissade::test {

/// What the three have in common; they add no member to it, so that its SameSensor does for them.
struct TwoViewData {
  using Vertices = VertexList<VertexPose, VertexPose, VertexInverseDepth>;
  static constexpr int kResidualDim = 2;
  static constexpr bool kIsObservation = true;
  static constexpr auto kScaleRule = ScaleRule::kRays;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;

  Vector2 uv_host = Vector2::Zero();
  Vector2 uv_target = Vector2::Zero();
  Pose T_b_c;

  [[nodiscard]] bool SameSensor(const TwoViewData& other) const { return T_b_c == other.T_b_c; }
};

/// The same observation by another type of edge.
template <class E>
E CopyOf(const EdgeReprojection& from) {
  E edge;
  edge.uv_host = from.uv_host;
  edge.uv_target = from.uv_target;
  edge.T_b_c = from.T_b_c;
  return edge;
}

/// One at a time, with Eigen.
struct ReprojectionOneByOne : TwoViewData {
  bool Evaluate(const VertexPose& host, const VertexPose& target, const VertexInverseDepth& depth,
                Vector2& r, Jacobian<2, 6>* d_host, Jacobian<2, 6>* d_target,
                Jacobian<2, 1>* d_rho) const {
    const Matrix3 R_i = host.pose.R(), R_j = target.pose.R(), R_c = T_b_c.R();
    const Vector3 bearing(uv_host[0], uv_host[1], 1.0);
    const Vector3 h = R_c * bearing + depth.rho * T_b_c.p();
    const Vector3 y = R_j.transpose() * (R_i * h + depth.rho * (host.pose.p() - target.pose.p()));
    const Vector3 q = R_c.transpose() * (y - depth.rho * T_b_c.p());
    if (q[2] == 0.0) return false;
    r = q.head<2>() / q[2] - uv_target;
    Matrix<2, 3> d_q;
    d_q << 1.0 / q[2], 0.0, -q[0] / (q[2] * q[2]), 0.0, 1.0 / q[2], -q[1] / (q[2] * q[2]);
    const Matrix<2, 3> d_y = d_q * R_c.transpose(), d_w = d_y * R_j.transpose(), d_h = d_w * R_i;
    if (d_host != nullptr) {
      d_host->leftCols<3>() = depth.rho * d_w;
      d_host->rightCols<3>() = -d_h * so3::Hat(h);
    }
    if (d_target != nullptr) {
      d_target->leftCols<3>() = -depth.rho * d_w;
      d_target->rightCols<3>() = d_y * so3::Hat(y);
    }
    if (d_rho != nullptr) {
      *d_rho = d_h * T_b_c.p() + d_w * (host.pose.p() - target.pose.p()) - d_y * T_b_c.p();
    }
    return true;
  }
};

/// The residual of the template forms: rho * point in the target camera, and its rows by pose.
template <class T>
struct TwoViewPack {
  Vec<T, 3> h, y, q;
  View<VertexPose, T> camera;

  TwoViewPack(const Pose& T_b_c, const View<VertexPose, T>& host, const View<VertexPose, T>& target,
              const T& rho, const Vec<T, 2>& uv)
      : camera(internal::ViewOf<T>(T_b_c)) {
    const Vec<T, 3> bearing = {{uv[0], uv[1], T(1.0)}};
    h = camera.R * bearing + rho * camera.p;
    y = TransposeTimes(target.R, host.R * h + rho * (host.p - target.p));
    q = TransposeTimes(camera.R, y - rho * camera.p);
  }
};

/// In packs.
struct ReprojectionInPacks : TwoViewData {
  static constexpr auto kLanes =
      Fields(&ReprojectionInPacks::uv_host, &ReprojectionInPacks::uv_target);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& host, const View<VertexPose, T>& target,
                const View<VertexInverseDepth, T>& depth, const Vec<T, 2>& host_uv,
                const Vec<T, 2>& target_uv, Vec<T, 2>& r, Mat<T, 2, 6>* d_host,
                Mat<T, 2, 6>* d_target, Mat<T, 2, 1>* d_rho) const {
    const TwoViewPack<T> x(T_b_c, host, target, depth.rho, host_uv);
    const T inv_z = T(1.0) / x.q[2], u = x.q[0] * inv_z, v = x.q[1] * inv_z;
    r = {{u - target_uv[0], v - target_uv[1]}};
    if (!d_host && !d_target && !d_rho) return true;
    const Mat<T, 2, 3> d_q = {{inv_z, T(0.0), -u * inv_z, T(0.0), inv_z, -v * inv_z}};
    const Mat<T, 2, 3> d_y = d_q * x.camera.R.Transpose(), d_w = d_y * target.R.Transpose(),
                       d_h = d_w * host.R;
    for (int row = 0; row < 2; ++row) {
      if (d_host) {
        d_host->Set(row, 0, depth.rho * d_w.Row(row));
        d_host->Set(row, 3, Cross(x.h, d_h.Row(row)));
      }
      if (d_target) {
        d_target->Set(row, 0, -(depth.rho * d_w.Row(row)));
        d_target->Set(row, 3, Cross(d_y.Row(row), x.y));
      }
    }
    if (d_rho) *d_rho = d_h * x.camera.p + d_w * (host.p - target.p) - d_y * x.camera.p;
    return true;
  }
};

/// Without Jacobians.
struct ReprojectionResidual : TwoViewData {
  static constexpr auto kLanes =
      Fields(&ReprojectionResidual::uv_host, &ReprojectionResidual::uv_target);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& host, const View<VertexPose, T>& target,
                const View<VertexInverseDepth, T>& depth, const Vec<T, 2>& host_uv,
                const Vec<T, 2>& target_uv, Vec<T, 2>& r) const {
    const TwoViewPack<T> x(T_b_c, host, target, depth.rho, host_uv);
    r = {{x.q[0] / x.q[2] - target_uv[0], x.q[1] / x.q[2] - target_uv[1]}};
    return true;
  }
};

}  // namespace glissade::test
