// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/edges/lanes.h"
#include "glissade/edges/point_in_camera.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/pose_view.h"

namespace glissade {

/// Position of a point in the world as a sensor on the body has measured it: a depth camera, a
/// lidar, a stereo pair that triangulates.
///
/// Vertices: T_W_B, X_W. With R_bs and t_bs the parts of T_b_s,
///     r = R_bs' (R' (X - p) - t_bs) - p_s   (m, axes of the sensor).
/// A point may be measured several times from one pose: these are no duplicates.
struct EdgePosePoint {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 3;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePoint;

  Vector3 p_s = Vector3::Zero();  ///< measured, m
  /// Sensor in body: x_b = T_b_s x_s.
  Pose T_b_s;

  static constexpr auto kLanes = Fields(&EdgePosePoint::p_s);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const Vec<T, 3>& measured, Vec<T, 3>& r, Mat<T, 3, 6>* d_r_d_pose,
                Mat<T, 3, 3>* d_r_d_point) const {
    const internal::PointInCamera<T> x(pose, point, T_b_s);
    r = x.x_c - measured;
    if (!internal::HasValue(r)) return false;
    if (!d_r_d_pose && !d_r_d_point) return true;
    const Mat<T, 3, 3> R_s_b = x.camera_in_body.R.Transpose();
    const Mat<T, 3, 3> R_s_w = R_s_b * pose.R.Transpose();
    if (d_r_d_pose) {
      d_r_d_pose->Set(0, 0, -R_s_w);
      for (int row = 0; row < 3; ++row)
        d_r_d_pose->Set(row, 3, Cross(R_s_b.Row(row), x.x_b));
    }
    if (d_r_d_point) *d_r_d_point = R_s_w;
    return true;
  }
  bool Evaluate(const VertexPose& pose, const VertexPointXYZ& point, Vector3& r,
                Jacobian<3, 6>* d_r_d_pose, Jacobian<3, 3>* d_r_d_point) const {
    return internal::EvaluateInDouble(*this, std::tie(pose, point), r, d_r_d_pose, d_r_d_point);
  }

  [[nodiscard]] bool SameInRun(const EdgePosePoint& other) const { return T_b_s == other.T_b_s; }

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidateFinite(p_s.data(), 3, "measured point"); !s.ok()) return s;
    return ValidatePose(T_b_s.data, "sensor in body");
  }
};

template <>
inline constexpr TypeInfo kTypeInfo<EdgePosePoint>{"EdgePosePoint"};
extern template struct internal::EdgeOpsOf<EdgePosePoint>;

}  // namespace glissade
