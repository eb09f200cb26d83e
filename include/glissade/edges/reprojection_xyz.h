// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <concepts>

#include "glissade/base/validate.h"
#include "glissade/cameras/identity.h"
#include "glissade/cameras/pinhole.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/edges/lanes.h"
#include "glissade/edges/point_in_camera.h"
#include "glissade/edges/two_view_observation.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/pose_view.h"

namespace glissade {

/// Observation of a point in the world by a camera on the body.
///
/// Vertices: T_W_B, X_W. With R_bc and t_bc the parts of T_b_c,
///     P = R_bc' (R' (X - p) - t_bc),   r = project(P) - uv.
/// Evaluated behind the camera; no value where P.z = 0.
template <CameraModel Camera = CameraIdentity>
struct EdgeReprojectionXYZOf {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 2;
  static constexpr bool kIsObservation = true;
  static constexpr auto kScaleRule = ScaleRule::kRays;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePoint;

  /// Image coordinates: normalized (x/z, y/z) for CameraIdentity, else the camera's.
  Vector2 uv = Vector2::Zero();
  /// Camera in body: x_b = T_b_c x_c.
  Pose T_b_c;
  [[no_unique_address]] Camera camera{};

  static constexpr bool kInLanes = internal::LaneCamera<Camera>;
  static constexpr auto kLanes = Fields(&EdgeReprojectionXYZOf::uv);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const Vec<T, 2>& measured, Vec<T, 2>& r, Mat<T, 2, 6>* d_r_d_pose,
                Mat<T, 2, 3>* d_r_d_point) const {
    const internal::PointInCamera<T> x(pose, point, T_b_c);
    const bool linearize = d_r_d_pose || d_r_d_point;
    Mat<T, 2, 3> d_r_d_c;
    if (!internal::ProjectLanes(camera, x.x_c, r, linearize ? &d_r_d_c : nullptr)) return false;
    if (!internal::HasValue(r)) return false;
    r = r - measured;
    if (linearize) x.Derivatives(pose, d_r_d_c, d_r_d_pose, d_r_d_point);
    return true;
  }
  bool Evaluate(const VertexPose& pose, const VertexPointXYZ& point, Vector2& r,
                Jacobian<2, 6>* d_r_d_pose, Jacobian<2, 3>* d_r_d_point) const {
    return internal::EvaluateInDouble(*this, std::tie(pose, point), r, d_r_d_pose, d_r_d_point);
  }

  [[nodiscard]] TwoViewObservation TwoView() const requires std::same_as<Camera, CameraIdentity> {
    return {nullptr, uv.data(), nullptr, T_b_c.data};
  }
  [[nodiscard]] TwoViewObservation TwoView() const requires std::same_as<Camera, CameraPinhole> {
    return {
        nullptr, uv.data(), nullptr, T_b_c.data, {camera.fx, camera.fy}, {camera.cx, camera.cy}};
  }

  /// Same camera: two observations of one point by it in one frame are duplicates.
  [[nodiscard]] bool SameSensor(const EdgeReprojectionXYZOf& other) const {
    return T_b_c == other.T_b_c && camera == other.camera;
  }

  /// z of the point in the camera (m).
  [[nodiscard]] double Depth(const VertexPose& pose, const VertexPointXYZ& point) const {
    const Vector3 x_b = pose.pose.R().transpose() * (point.p() - pose.pose.p());
    return T_b_c.R().col(2).dot(x_b - T_b_c.p());
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidateFinite(uv.data(), 2, "observation"); !s.ok()) return s;
    if (Status s = ValidatePose(T_b_c.data, "extrinsic"); !s.ok()) return s;
    return ValidateCamera(camera);
  }
};

/// The edge on normalized coordinates.
using EdgeReprojectionXYZ = EdgeReprojectionXYZOf<CameraIdentity>;
template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojectionXYZ>{"EdgeReprojectionXYZ"};
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeReprojectionXYZ> = true;
extern template struct internal::EdgeOpsOf<EdgeReprojectionXYZ>;
template <>
inline constexpr bool internal::kHasTwoView<EdgeReprojectionXYZOf<CameraPinhole>> = true;

}  // namespace glissade
