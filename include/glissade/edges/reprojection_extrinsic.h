// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/cameras/identity.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/edges/lanes.h"
#include "glissade/edges/two_view_point.h"

namespace glissade {

/// EdgeReprojection with the extrinsic as a vertex, for online calibration.
///
/// Vertices: T_W_Bi, T_W_Bj, rho, T_B_C (camera in body, shared by both frames). Residual, failure
/// and observations as in EdgeReprojection.
template <CameraModel Camera = CameraIdentity>
struct EdgeReprojectionExtrinsicOf {
  using Vertices = VertexList<VertexPose, VertexPose, VertexInverseDepth, VertexPose>;
  static constexpr int kResidualDim = 2;
  static constexpr bool kIsObservation = true;
  static constexpr auto kScaleRule = ScaleRule::kRays;
  static constexpr int kExtrinsicVertex = 3;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;

  Vector2 uv_host = Vector2::Zero();    ///< normalized coordinates of the host's ray
  Vector2 uv_target = Vector2::Zero();  ///< image coordinates of `camera` in the target frame
  [[no_unique_address]] Camera camera{};

  static constexpr bool kInLanes = internal::LaneCamera<Camera>;
  static constexpr auto kLanes =
      Fields(&EdgeReprojectionExtrinsicOf::uv_host, &EdgeReprojectionExtrinsicOf::uv_target);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& host, const View<VertexPose, T>& target,
                const View<VertexInverseDepth, T>& depth, const View<VertexPose, T>& extrinsic,
                const Vec<T, 2>& host_uv, const Vec<T, 2>& target_uv, Vec<T, 2>& r,
                Mat<T, 2, 6>* d_r_d_host, Mat<T, 2, 6>* d_r_d_target, Mat<T, 2, 1>* d_r_d_rho,
                Mat<T, 2, 6>* d_r_d_extrinsic) const {
    const internal::TwoViewPoint<T> x(host, target, depth.rho, host_uv, extrinsic, extrinsic);
    const bool linearize = d_r_d_host || d_r_d_target || d_r_d_rho || d_r_d_extrinsic;
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
    if (d_r_d_extrinsic) d.SharedExtrinsic(*d_r_d_extrinsic);
    return true;
  }
  bool Evaluate(const VertexPose& host, const VertexPose& target, const VertexInverseDepth& depth,
                const VertexPose& extrinsic, Vector2& r, Jacobian<2, 6>* d_r_d_host,
                Jacobian<2, 6>* d_r_d_target, Jacobian<2, 1>* d_r_d_rho,
                Jacobian<2, 6>* d_r_d_extrinsic) const {
    return internal::EvaluateInDouble(*this, std::tie(host, target, depth, extrinsic), r,
                                      d_r_d_host, d_r_d_target, d_r_d_rho, d_r_d_extrinsic);
  }

  /// The extrinsic is a vertex, so that two edges on the same vertices are by the same camera.
  [[nodiscard]] bool SameSensor(const EdgeReprojectionExtrinsicOf& other) const {
    return camera == other.camera;
  }

  /// As EdgeReprojection::Depth.
  [[nodiscard]] double Depth(const VertexPose& host, const VertexPose& target,
                             const VertexInverseDepth& depth, const VertexPose& extrinsic) const {
    return internal::TwoViewDepth(host.pose, target.pose, depth.rho, uv_host, extrinsic.pose,
                                  extrinsic.pose);
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidateFinite(uv_host.data(), 2, "host observation"); !s.ok()) return s;
    if (Status s = ValidateFinite(uv_target.data(), 2, "target observation"); !s.ok()) return s;
    return ValidateCamera(camera);
  }
};

/// The edge on normalized coordinates.
using EdgeReprojectionExtrinsic = EdgeReprojectionExtrinsicOf<CameraIdentity>;
template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojectionExtrinsic>{"EdgeReprojectionExtrinsic"};
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeReprojectionExtrinsic> = true;
extern template struct internal::EdgeOpsOf<EdgeReprojectionExtrinsic>;

}  // namespace glissade
