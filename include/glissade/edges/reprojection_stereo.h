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

/// Observation of an inverse-depth landmark of one camera by another camera of the body in another
/// frame (left host, right target).
///
/// Vertices: T_W_Bi, T_W_Bj, rho. As EdgeReprojection, with two extrinsics:
///     P = R_t' (R_j' (R_i (R_h b / rho + t_h) + p_i - p_j) - t_t),   r = project(P) - uv_target,
/// R_h, t_h of T_b_host and R_t, t_t of T_b_target. For the same frame: EdgeReprojectionStereoSame.
template <CameraModel Camera = CameraIdentity>
struct EdgeReprojectionStereoOf {
  using Vertices = VertexList<VertexPose, VertexPose, VertexInverseDepth>;
  static constexpr int kResidualDim = 2;
  static constexpr bool kIsObservation = true;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;

  Vector2 uv_host = Vector2::Zero();      ///< normalized coordinates of the host's ray
  Vector2 uv_target = Vector2::Zero();    ///< image coordinates of `camera` in the target frame
  Pose T_b_host;                          ///< camera of the host observation in body
  Pose T_b_target;                        ///< camera of the target observation in body
  [[no_unique_address]] Camera camera{};  ///< of the target observation

  static constexpr bool kInLanes = internal::LaneCamera<Camera>;
  static constexpr auto kLanes =
      Fields(&EdgeReprojectionStereoOf::uv_host, &EdgeReprojectionStereoOf::uv_target);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& host, const View<VertexPose, T>& target,
                const View<VertexInverseDepth, T>& depth, const Vec<T, 2>& host_uv,
                const Vec<T, 2>& target_uv, Vec<T, 2>& r, Mat<T, 2, 6>* d_r_d_host,
                Mat<T, 2, 6>* d_r_d_target, Mat<T, 2, 1>* d_r_d_rho) const {
    const auto host_camera = internal::ViewOf<T>(T_b_host);
    const auto target_camera = internal::ViewOf<T>(T_b_target);
    const internal::TwoViewPoint<T> x(host, target, depth.rho, host_uv, host_camera, target_camera);
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
    return {uv_host.data(), uv_target.data(), T_b_host.data, T_b_target.data};
  }
  [[nodiscard]] TwoViewObservation TwoView() const requires std::same_as<Camera, CameraPinhole> {
    return {uv_host.data(),  uv_target.data(),       T_b_host.data,
            T_b_target.data, {camera.fx, camera.fy}, {camera.cx, camera.cy}};
  }

  /// Both cameras, as duplicates do not ask for.
  [[nodiscard]] bool SameInRun(const EdgeReprojectionStereoOf& other) const {
    return T_b_host == other.T_b_host && SameSensor(other);
  }

  /// Same target camera: two observations of one landmark by it in one frame are duplicates.
  [[nodiscard]] bool SameSensor(const EdgeReprojectionStereoOf& other) const {
    return T_b_target == other.T_b_target && camera == other.camera;
  }

  /// As EdgeReprojection::Depth.
  [[nodiscard]] double Depth(const VertexPose& host, const VertexPose& target,
                             const VertexInverseDepth& depth) const {
    return internal::TwoViewDepth(host.pose, target.pose, depth.rho, uv_host, T_b_host, T_b_target);
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidateFinite(uv_host.data(), 2, "host observation"); !s.ok()) return s;
    if (Status s = ValidateFinite(uv_target.data(), 2, "target observation"); !s.ok()) return s;
    if (Status s = ValidatePose(T_b_host.data, "extrinsic of the host"); !s.ok()) return s;
    if (Status s = ValidatePose(T_b_target.data, "extrinsic of the target"); !s.ok()) return s;
    return ValidateCamera(camera);
  }
};

/// The edge on normalized coordinates.
using EdgeReprojectionStereo = EdgeReprojectionStereoOf<CameraIdentity>;
template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojectionStereo>{"EdgeReprojectionStereo"};
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeReprojectionStereo> = true;
extern template struct internal::EdgeOpsOf<EdgeReprojectionStereo>;
template <>
inline constexpr bool internal::kHasTwoView<EdgeReprojectionStereoOf<CameraPinhole>> = true;

}  // namespace glissade
