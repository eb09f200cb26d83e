// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>

#include "glissade/base/validate.h"
#include "glissade/cameras/identity.h"
#include "glissade/cameras/pinhole.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/edges/lanes.h"
#include "glissade/edges/two_view_observation.h"
#include "glissade/edges/two_view_point.h"

namespace glissade {

/// Observation of an inverse-depth landmark of host frame i in another frame j by the same camera.
///
/// Vertices: T_W_Bi, T_W_Bj, rho. With b = (uv_host, 1), R and t the parts of T_b_c,
///     P = R' (R_j' (R_i (R b / rho + t) + p_i - p_j) - t),   r = project(P) - uv_target.
/// The host observation is taken as exact. Evaluated behind the camera and at rho = 0; no value
/// where P.z = 0.
template <CameraModel Camera = CameraIdentity>
struct EdgeReprojectionOf {
  using Vertices = VertexList<VertexPose, VertexPose, VertexInverseDepth>;
  static constexpr int kResidualDim = 2;
  static constexpr bool kIsObservation = true;
  static constexpr auto kScaleRule = ScaleRule::kRays;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;

  /// Normalized coordinates (x/z, y/z) of the host's ray, whatever the camera model: unproject
  /// once.
  Vector2 uv_host = Vector2::Zero();
  /// Image coordinates in the target frame: normalized for CameraIdentity, else the camera's.
  Vector2 uv_target = Vector2::Zero();
  /// Camera in body: x_b = T_b_c x_c.
  Pose T_b_c;
  [[no_unique_address]] Camera camera{};

  static constexpr bool kInLanes = internal::LaneCamera<Camera>;
  static constexpr auto kLanes =
      Fields(&EdgeReprojectionOf::uv_host, &EdgeReprojectionOf::uv_target);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& host, const View<VertexPose, T>& target,
                const View<VertexInverseDepth, T>& depth, const Vec<T, 2>& host_uv,
                const Vec<T, 2>& target_uv, Vec<T, 2>& r, Mat<T, 2, 6>* d_r_d_host,
                Mat<T, 2, 6>* d_r_d_target, Mat<T, 2, 1>* d_r_d_rho) const {
    const auto camera_in_body = internal::ViewOf<T>(T_b_c);
    const internal::TwoViewPoint<T> x(host, target, depth.rho, host_uv, camera_in_body,
                                      camera_in_body);
    const bool linearize = d_r_d_host || d_r_d_target || d_r_d_rho;
    Mat<T, 2, 3> d_r_d_c;
    if (!internal::ProjectScaled(camera, x.q, x.rho, r, linearize ? &d_r_d_c : nullptr)) {
      return false;
    }
    r = r - target_uv;
    if (!linearize) return true;
    const internal::TwoViewDerivatives<T> d(x, d_r_d_c);
    if (d_r_d_host) d.Host(*d_r_d_host);
    if (d_r_d_target) d.Target(*d_r_d_target);
    if (d_r_d_rho) d.InverseDepth(*d_r_d_rho);
    return true;
  }
  bool Evaluate(const VertexPose& host, const VertexPose& target, const VertexInverseDepth& depth,
                Vector2& r, Jacobian<2, 6>* d_r_d_host, Jacobian<2, 6>* d_r_d_target,
                Jacobian<2, 1>* d_r_d_rho) const {
    return internal::EvaluateInDouble(*this, std::tie(host, target, depth), r, d_r_d_host,
                                      d_r_d_target, d_r_d_rho);
  }

  [[nodiscard]] TwoViewObservation TwoView() const requires std::same_as<Camera, CameraIdentity> {
    return {uv_host.data(), uv_target.data(), T_b_c.data, T_b_c.data};
  }
  [[nodiscard]] TwoViewObservation TwoView() const requires std::same_as<Camera, CameraPinhole> {
    return {uv_host.data(), uv_target.data(),       T_b_c.data,
            T_b_c.data,     {camera.fx, camera.fy}, {camera.cx, camera.cy}};
  }

  /// Same camera: two observations of one landmark by it in one frame are duplicates.
  [[nodiscard]] bool SameSensor(const EdgeReprojectionOf& other) const {
    return T_b_c == other.T_b_c && camera == other.camera;
  }

  /// z in the target camera (m); if the landmark lies behind its host, the smaller of that and
  /// 1/rho.
  [[nodiscard]] double Depth(const VertexPose& host, const VertexPose& target,
                             const VertexInverseDepth& depth) const {
    return internal::TwoViewDepth(host.pose, target.pose, depth.rho, uv_host, T_b_c, T_b_c);
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidateFinite(uv_host.data(), 2, "host observation"); !s.ok()) return s;
    if (Status s = ValidateFinite(uv_target.data(), 2, "target observation"); !s.ok()) return s;
    if (Status s = ValidatePose(T_b_c.data, "extrinsic"); !s.ok()) return s;
    return ValidateCamera(camera);
  }
};

/// The edge on normalized coordinates.
using EdgeReprojection = EdgeReprojectionOf<CameraIdentity>;
template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojection>{"EdgeReprojection"};
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeReprojection> = true;
extern template struct internal::EdgeOpsOf<EdgeReprojection>;
template <>
inline constexpr bool internal::kHasTwoView<EdgeReprojectionOf<CameraPinhole>> = true;

}  // namespace glissade
