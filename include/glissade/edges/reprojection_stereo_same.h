// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/cameras/identity.h"
#include "glissade/edges/concept.h"
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

  bool Evaluate(const VertexInverseDepth& depth, Vector2& r, Jacobian<2, 1>* d_r_d_rho) const {
    const double rho = depth.rho;
    Vector3 d_q_d_rho;
    const Vector3 q = ScaledPoint(rho, d_q_d_rho);
    Matrix<2, 3> d_r_d_c;
    if (!internal::ProjectScaled(camera, q, rho, r, d_r_d_rho ? &d_r_d_c : nullptr)) return false;
    r -= uv_target;
    if (d_r_d_rho) d_r_d_rho->noalias() = d_r_d_c * d_q_d_rho;
    return true;
  }

  /// Same target camera: two observations of one landmark by it in its host frame are duplicates.
  [[nodiscard]] bool SameSensor(const EdgeReprojectionStereoSameOf& other) const {
    return T_b_target == other.T_b_target && camera == other.camera;
  }

  /// As EdgeReprojection::Depth.
  [[nodiscard]] double Depth(const VertexInverseDepth& depth) const {
    Vector3 unused;
    return internal::TwoViewDepth(ScaledPoint(depth.rho, unused)[2], depth.rho);
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
  [[nodiscard]] Vector3 ScaledPoint(double rho, Vector3& d_q_d_rho) const {
    const Matrix3 R_target_b = T_b_target.R().transpose();
    d_q_d_rho.noalias() = R_target_b * (T_b_host.p() - T_b_target.p());
    return R_target_b * (T_b_host.R() * Vector3(uv_host[0], uv_host[1], 1.0)) + rho * d_q_d_rho;
  }
};

/// The edge on normalized coordinates.
using EdgeReprojectionStereoSame = EdgeReprojectionStereoSameOf<CameraIdentity>;
template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojectionStereoSame>{"EdgeReprojectionStereoSame"};

}  // namespace glissade
