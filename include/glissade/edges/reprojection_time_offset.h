// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/cameras/identity.h"
#include "glissade/edges/concept.h"
#include "glissade/edges/timed_observation.h"
#include "glissade/edges/two_view_point.h"
#include "glissade/vertices/vector.h"

namespace glissade {

/// EdgeReprojection with the camera's time offset as a vertex.
///
/// Vertices: T_W_Bi, T_W_Bj, rho, td (s). EdgeReprojection's residual with the observations
/// host.At(td) and target.At(td); see TimedObservation for the sign of td.
template <CameraModel Camera = CameraIdentity>
struct EdgeReprojectionTimeOffsetOf {
  using Vertices = VertexList<VertexPose, VertexPose, VertexInverseDepth, VertexVector<1>>;
  static constexpr int kResidualDim = 2;
  static constexpr bool kIsObservation = true;
  static constexpr auto kScaleRule = ScaleRule::kRays;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;

  TimedObservation host;    ///< normalized coordinates of the host's ray, and their velocity
  TimedObservation target;  ///< image coordinates of `camera` in the target frame
  Pose T_b_c;               ///< camera in body
  [[no_unique_address]] Camera camera{};

  bool Evaluate(const VertexPose& pose_i, const VertexPose& pose_j, const VertexInverseDepth& depth,
                const VertexVector<1>& time_offset, Vector2& r, Jacobian<2, 6>* d_r_d_pose_i,
                Jacobian<2, 6>* d_r_d_pose_j, Jacobian<2, 1>* d_r_d_rho,
                Jacobian<2, 1>* d_r_d_td) const {
    const double td = time_offset.value[0];
    const internal::TwoViewPoint x(pose_i.pose, pose_j.pose, depth.rho, host.At(td), T_b_c, T_b_c);
    const bool linearize = d_r_d_pose_i || d_r_d_pose_j || d_r_d_rho || d_r_d_td;
    Matrix<2, 3> d_r_d_c;
    if (!internal::ProjectScaled(camera, x.q, x.rho, r, linearize ? &d_r_d_c : nullptr)) {
      return false;
    }
    r -= target.At(td);
    if (!linearize) return true;
    const internal::TwoViewDerivatives d(x, d_r_d_c);
    if (d_r_d_pose_i) d.Host(*d_r_d_pose_i);
    if (d_r_d_pose_j) d.Target(*d_r_d_pose_j);
    if (d_r_d_rho) d.InverseDepth(pose_i.pose, pose_j.pose, *d_r_d_rho);
    if (d_r_d_td) {
      Matrix2 d_r_d_uv_host;
      d.HostObservation(d_r_d_uv_host);
      *d_r_d_td = target.velocity - d_r_d_uv_host * host.velocity;
    }
    return true;
  }

  /// Same camera: two observations of one landmark by it in one frame are duplicates.
  [[nodiscard]] bool SameSensor(const EdgeReprojectionTimeOffsetOf& other) const {
    return T_b_c == other.T_b_c && camera == other.camera;
  }

  /// As EdgeReprojection::Depth.
  [[nodiscard]] double Depth(const VertexPose& pose_i, const VertexPose& pose_j,
                             const VertexInverseDepth& depth,
                             const VertexVector<1>& time_offset) const {
    const internal::TwoViewPoint x(pose_i.pose, pose_j.pose, depth.rho,
                                   host.At(time_offset.value[0]), T_b_c, T_b_c);
    return internal::TwoViewDepth(x.q[2], x.rho);
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = host.Validate("host observation"); !s.ok()) return s;
    if (Status s = target.Validate("target observation"); !s.ok()) return s;
    if (Status s = ValidatePose(T_b_c.data, "extrinsic"); !s.ok()) return s;
    return ValidateCamera(camera);
  }
};

/// The edge on normalized coordinates.
using EdgeReprojectionTimeOffset = EdgeReprojectionTimeOffsetOf<CameraIdentity>;
template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojectionTimeOffset>{"EdgeReprojectionTimeOffset"};

}  // namespace glissade
