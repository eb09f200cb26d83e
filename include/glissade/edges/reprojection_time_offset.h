// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/cameras/identity.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/edges/lanes.h"
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

  static constexpr bool kInLanes = internal::LaneCamera<Camera>;
  static constexpr auto kLanes =
      Fields(&EdgeReprojectionTimeOffsetOf::host, &EdgeReprojectionTimeOffsetOf::target);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose_i, const View<VertexPose, T>& pose_j,
                const View<VertexInverseDepth, T>& depth, const View<VertexVector<1>, T>& offset,
                const Vec<T, 5>& at_host, const Vec<T, 5>& at_target, Vec<T, 2>& r,
                Mat<T, 2, 6>* d_r_d_pose_i, Mat<T, 2, 6>* d_r_d_pose_j, Mat<T, 2, 1>* d_r_d_rho,
                Mat<T, 2, 1>* d_r_d_td) const {
    const auto camera_in_body = internal::ViewOf<T>(T_b_c);
    const internal::TwoViewPoint<T> x(pose_i, pose_j, depth.rho,
                                      internal::ObservedAt(at_host, offset[0]), camera_in_body,
                                      camera_in_body);
    const bool linearize = d_r_d_pose_i || d_r_d_pose_j || d_r_d_rho || d_r_d_td;
    Mat<T, 2, 3> d_r_d_c;
    if (!internal::ProjectScaled(camera, x.q, x.rho, r, linearize ? &d_r_d_c : nullptr)) {
      return false;
    }
    r = r - internal::ObservedAt(at_target, offset[0]);
    if (!linearize) return true;
    const internal::TwoViewDerivatives<T> d(x, d_r_d_c);
    if (d_r_d_pose_i) d.Host(*d_r_d_pose_i);
    if (d_r_d_pose_j) d.Target(*d_r_d_pose_j);
    if (d_r_d_rho) d.InverseDepth(*d_r_d_rho);
    if (d_r_d_td) {
      *d_r_d_td = internal::ObservedVelocity(at_target) -
                  d.HostObservation(internal::ObservedVelocity(at_host));
    }
    return true;
  }
  bool Evaluate(const VertexPose& pose_i, const VertexPose& pose_j, const VertexInverseDepth& depth,
                const VertexVector<1>& time_offset, Vector2& r, Jacobian<2, 6>* d_r_d_pose_i,
                Jacobian<2, 6>* d_r_d_pose_j, Jacobian<2, 1>* d_r_d_rho,
                Jacobian<2, 1>* d_r_d_td) const {
    return internal::EvaluateInDouble(*this, std::tie(pose_i, pose_j, depth, time_offset), r,
                                      d_r_d_pose_i, d_r_d_pose_j, d_r_d_rho, d_r_d_td);
  }

  /// Same camera: two observations of one landmark by it in one frame are duplicates.
  [[nodiscard]] bool SameSensor(const EdgeReprojectionTimeOffsetOf& other) const {
    return T_b_c == other.T_b_c && camera == other.camera;
  }

  /// As EdgeReprojection::Depth.
  [[nodiscard]] double Depth(const VertexPose& pose_i, const VertexPose& pose_j,
                             const VertexInverseDepth& depth,
                             const VertexVector<1>& time_offset) const {
    return internal::TwoViewDepth(pose_i.pose, pose_j.pose, depth.rho,
                                  host.At(time_offset.value[0]), T_b_c, T_b_c);
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
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeReprojectionTimeOffset> = true;
extern template struct internal::EdgeOpsOf<EdgeReprojectionTimeOffset>;

}  // namespace glissade
