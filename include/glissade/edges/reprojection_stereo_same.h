// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/cameras/identity.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/edges/lanes.h"
#include "glissade/edges/two_view_point.h"

namespace glissade {

/// Observation of an inverse-depth landmark by another camera of the body in the landmark's own
/// host frame (left host, right target). Where the body is does not matter, so that rho is the only
/// vertex:
///     P = R_t' (R_h b / rho + t_h - t_t),   r = project(P) - uv_target,
/// R_h, t_h of T_b_host and R_t, t_t of T_b_target, b = (uv_host, 1).
template <CameraModel Camera = CameraIdentity>
struct EdgeReprojectionStereoSameOf {
  using Vertices = VertexList<VertexInverseDepth>;
  static constexpr int kResidualDim = 2;
  static constexpr bool kIsObservation = true;

  Vector2 uv_host = Vector2::Zero();      ///< normalized coordinates of the host's ray
  Vector2 uv_target = Vector2::Zero();    ///< image coordinates of `camera`
  Pose T_b_host;                          ///< camera of the host observation in body
  Pose T_b_target;                        ///< camera of the target observation in body
  [[no_unique_address]] Camera camera{};  ///< of the target observation

  static constexpr bool kInLanes = internal::LaneCamera<Camera>;
  static constexpr auto kLanes =
      Fields(&EdgeReprojectionStereoSameOf::uv_host, &EdgeReprojectionStereoSameOf::uv_target);

  template <class T>
  bool Evaluate(const View<VertexInverseDepth, T>& depth, const Vec<T, 2>& host_uv,
                const Vec<T, 2>& target_uv, Vec<T, 2>& r, Mat<T, 2, 1>* d_r_d_rho) const {
    Vec<T, 3> d_q_d_rho;
    const Vec<T, 3> q = ScaledPoint(depth.rho, host_uv, d_q_d_rho);
    Mat<T, 2, 3> d_r_d_c;
    if (!internal::ProjectScaled(camera, q, depth.rho, r, d_r_d_rho ? &d_r_d_c : nullptr)) {
      return false;
    }
    r = r - target_uv;
    if (d_r_d_rho) *d_r_d_rho = d_r_d_c * d_q_d_rho;
    return true;
  }
  bool Evaluate(const VertexInverseDepth& depth, Vector2& r, Jacobian<2, 1>* d_r_d_rho) const {
    return internal::EvaluateInDouble(*this, std::tie(depth), r, d_r_d_rho);
  }

  /// Both cameras, as duplicates do not ask for.
  [[nodiscard]] bool SameInRun(const EdgeReprojectionStereoSameOf& other) const {
    return T_b_host == other.T_b_host && SameSensor(other);
  }

  /// Same target camera: two observations of one landmark by it in its host frame are duplicates.
  [[nodiscard]] bool SameSensor(const EdgeReprojectionStereoSameOf& other) const {
    return T_b_target == other.T_b_target && camera == other.camera;
  }

  /// As EdgeReprojection::Depth.
  [[nodiscard]] double Depth(const VertexInverseDepth& depth) const {
    Vec<double, 3> unused;
    const Vec<double, 2> uv = {{uv_host[0], uv_host[1]}};
    return internal::TwoViewDepth(ScaledPoint(depth.rho, uv, unused)[2], depth.rho);
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidateFinite(uv_host.data(), 2, "host observation"); !s.ok()) return s;
    if (Status s = ValidateFinite(uv_target.data(), 2, "target observation"); !s.ok()) return s;
    if (Status s = ValidatePose(T_b_host.data, "extrinsic of the host"); !s.ok()) return s;
    if (Status s = ValidatePose(T_b_target.data, "extrinsic of the target"); !s.ok()) return s;
    return ValidateCamera(camera);
  }

 private:
  /// rho * point in the target camera, and its derivative.
  template <class T>
  Vec<T, 3> ScaledPoint(const T& rho, const Vec<T, 2>& uv, Vec<T, 3>& d_q_d_rho) const {
    const auto host = internal::ViewOf<T>(T_b_host), target = internal::ViewOf<T>(T_b_target);
    const Vec<T, 3> bearing = {{uv[0], uv[1], T(1.0)}};
    d_q_d_rho = TransposeTimes(target.R, host.p - target.p);
    return TransposeTimes(target.R, host.R * bearing) + rho * d_q_d_rho;
  }
};

/// The edge on normalized coordinates.
using EdgeReprojectionStereoSame = EdgeReprojectionStereoSameOf<CameraIdentity>;
template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojectionStereoSame>{"EdgeReprojectionStereoSame"};
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeReprojectionStereoSame> = true;
extern template struct internal::EdgeOpsOf<EdgeReprojectionStereoSame>;

}  // namespace glissade
