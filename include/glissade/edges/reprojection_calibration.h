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

/// EdgeReprojection with both the extrinsic and the time offset of the camera as vertices: online
/// calibration in space and time.
///
/// Vertices: T_W_Bi, T_W_Bj, rho, T_B_C, td (s); see EdgeReprojectionExtrinsic and
/// EdgeReprojectionTimeOffset.
template <CameraModel Camera = CameraIdentity>
struct EdgeReprojectionCalibrationOf {
  using Vertices =
      VertexList<VertexPose, VertexPose, VertexInverseDepth, VertexPose, VertexVector<1>>;
  static constexpr int kResidualDim = 2;
  static constexpr bool kIsObservation = true;
  static constexpr auto kScaleRule = ScaleRule::kRays;
  static constexpr int kExtrinsicVertex = 3;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;

  TimedObservation host;    ///< normalized coordinates of the host's ray, and their velocity
  TimedObservation target;  ///< image coordinates of `camera` in the target frame
  [[no_unique_address]] Camera camera{};

  static constexpr bool kInLanes = internal::LaneCamera<Camera>;
  static constexpr auto kLanes =
      Fields(&EdgeReprojectionCalibrationOf::host, &EdgeReprojectionCalibrationOf::target);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose_i, const View<VertexPose, T>& pose_j,
                const View<VertexInverseDepth, T>& depth, const View<VertexPose, T>& extrinsic,
                const View<VertexVector<1>, T>& offset, const Vec<T, 5>& at_host,
                const Vec<T, 5>& at_target, Vec<T, 2>& r, Mat<T, 2, 6>* d_r_d_pose_i,
                Mat<T, 2, 6>* d_r_d_pose_j, Mat<T, 2, 1>* d_r_d_rho, Mat<T, 2, 6>* d_r_d_extrinsic,
                Mat<T, 2, 1>* d_r_d_td) const {
    const internal::TwoViewPoint<T> x(
        pose_i, pose_j, depth.rho, internal::ObservedAt(at_host, offset[0]), extrinsic, extrinsic);
    const bool linearize = d_r_d_pose_i || d_r_d_pose_j || d_r_d_rho || d_r_d_extrinsic || d_r_d_td;
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
    if (d_r_d_extrinsic) d.SharedExtrinsic(*d_r_d_extrinsic);
    if (d_r_d_td) {
      *d_r_d_td = internal::ObservedVelocity(at_target) -
                  d.HostObservation(internal::ObservedVelocity(at_host));
    }
    return true;
  }
  bool Evaluate(const VertexPose& pose_i, const VertexPose& pose_j, const VertexInverseDepth& depth,
                const VertexPose& extrinsic, const VertexVector<1>& time_offset, Vector2& r,
                Jacobian<2, 6>* d_r_d_pose_i, Jacobian<2, 6>* d_r_d_pose_j,
                Jacobian<2, 1>* d_r_d_rho, Jacobian<2, 6>* d_r_d_extrinsic,
                Jacobian<2, 1>* d_r_d_td) const {
    return internal::EvaluateInDouble(
        *this, std::tie(pose_i, pose_j, depth, extrinsic, time_offset), r, d_r_d_pose_i,
        d_r_d_pose_j, d_r_d_rho, d_r_d_extrinsic, d_r_d_td);
  }

  /// The extrinsic is a vertex, so that two edges on the same vertices are by the same camera.
  [[nodiscard]] bool SameSensor(const EdgeReprojectionCalibrationOf& other) const {
    return camera == other.camera;
  }

  /// As EdgeReprojection::Depth.
  [[nodiscard]] double Depth(const VertexPose& pose_i, const VertexPose& pose_j,
                             const VertexInverseDepth& depth, const VertexPose& extrinsic,
                             const VertexVector<1>& time_offset) const {
    return internal::TwoViewDepth(pose_i.pose, pose_j.pose, depth.rho,
                                  host.At(time_offset.value[0]), extrinsic.pose, extrinsic.pose);
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = host.Validate("host observation"); !s.ok()) return s;
    if (Status s = target.Validate("target observation"); !s.ok()) return s;
    return ValidateCamera(camera);
  }
};

/// The edge on normalized coordinates.
using EdgeReprojectionCalibration = EdgeReprojectionCalibrationOf<CameraIdentity>;
template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojectionCalibration>{"EdgeReprojectionCalibration"};
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeReprojectionCalibration> = true;
extern template struct internal::EdgeOpsOf<EdgeReprojectionCalibration>;

}  // namespace glissade
