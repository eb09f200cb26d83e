// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/edges/reprojection_xyz.h"
#include "glissade/glissade.h"
#include "glissade/vertices/pose_view.h"

// Edges on points in all the forms that a user may write.
namespace glissade::test {

/// EdgeReprojectionXYZ as a user would write it.
struct PointData {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 2;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePoint;

  Vector2 uv = Vector2::Zero();
  Pose T_b_c;

  [[nodiscard]] bool SameSensor(const PointData& other) const { return T_b_c == other.T_b_c; }
};

/// One at a time.
struct PointOneByOne : PointData {
  bool Evaluate(const VertexPose& pose, const VertexPointXYZ& point, Vector2& r,
                Jacobian<2, 6>* d_pose, Jacobian<2, 3>* d_point) const {
    EdgeReprojectionXYZ edge;
    edge.uv = uv;
    edge.T_b_c = T_b_c;
    return edge.Evaluate(pose, point, r, d_pose, d_point);
  }
};

/// In packs, without Jacobians.
struct PointResidual : PointData {
  static constexpr auto kLanes = Fields(&PointResidual::uv);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const Vec<T, 2>& measured, Vec<T, 2>& r) const {
    const auto camera = internal::ViewOf<T>(T_b_c);
    const Vec<T, 3> y = TransposeTimes(pose.R, point.p - pose.p);
    const Vec<T, 3> q = TransposeTimes(camera.R, y - camera.p);
    r = {{q[0] / q[2] - measured[0], q[1] / q[2] - measured[1]}};
    return true;
  }
};

/// The vector from the body to the point: three rows.
struct PointOffset {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 3;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePoint;
  Vector3 measured = Vector3::Zero();

  bool Evaluate(const VertexPose& pose, const VertexPointXYZ& point, Vector3& r,
                Jacobian<3, 6>* d_pose, Jacobian<3, 3>* d_point) const {
    const Matrix3 Rt = pose.pose.R().transpose();
    const Vector3 x = Rt * (point.p() - pose.pose.p());
    r = x - measured;
    if (d_pose != nullptr) {
      d_pose->leftCols<3>() = -Rt;
      d_pose->rightCols<3>() = so3::Hat(x);
    }
    if (d_point != nullptr) *d_point = Rt;
    return true;
  }
};

/// On the point alone.
struct PointPrior {
  using Vertices = VertexList<VertexPointXYZ>;
  static constexpr int kResidualDim = 3;
  Vector3 mean = Vector3::Zero();

  bool Evaluate(const VertexPointXYZ& point, Vector3& r, Jacobian<3, 3>* d_point) const {
    r = point.p() - mean;
    if (d_point != nullptr) *d_point = Matrix3::Identity();
    return true;
  }
};

/// With the camera's pose in the body as a vertex.
struct PointExtrinsic {
  using Vertices = VertexList<VertexPose, VertexPointXYZ, VertexPose>;
  static constexpr int kResidualDim = 2;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePoint;
  static constexpr int kExtrinsicVertex = 2;
  Vector2 uv = Vector2::Zero();
  static constexpr auto kLanes = Fields(&PointExtrinsic::uv);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const View<VertexPose, T>& camera, const Vec<T, 2>& measured, Vec<T, 2>& r) const {
    const Vec<T, 3> y = TransposeTimes(pose.R, point.p - pose.p);
    const Vec<T, 3> q = TransposeTimes(camera.R, y - camera.p);
    r = {{q[0] / q[2] - measured[0], q[1] / q[2] - measured[1]}};
    return true;
  }
};

}  // namespace glissade::test
