// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/base/validate.h"
#include "glissade/cameras/intrinsics_fisheye.h"
#include "glissade/cameras/intrinsics_radial.h"
#include "glissade/cameras/intrinsics_radtan.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/edges/lanes.h"
#include "glissade/edges/point_in_camera.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/pose_view.h"
#include "glissade/vertices/vector.h"

namespace glissade {

/// EdgeReprojectionXYZ with the camera's intrinsics as a vertex, which images by the same camera
/// share.
///
/// Vertices: T_W_B, X_W, intrinsics (the numbers of Model; Graph::SetFixedNumbers holds some).
///     P = R_bc' (R' (X - p) - t_bc),   r = project(P, intrinsics) - uv   (px).
/// Evaluated behind the camera where Model is; no value where Model has none (P.z = 0, or the
/// backward axis of a fisheye).
template <IntrinsicsModel Model>
struct EdgeReprojectionIntrinsicsOf {
  static constexpr int kDim = Model::kDim;
  using Intrinsics = VertexVector<kDim>;
  using Vertices = VertexList<VertexPose, VertexPointXYZ, Intrinsics>;
  static constexpr int kResidualDim = 2;
  static constexpr bool kIsObservation = true;
  static constexpr auto kScaleRule = ScaleRule::kRays;
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePoint;

  Vector2 uv = Vector2::Zero();  ///< px
  /// Camera in body: x_b = T_b_c x_c.
  Pose T_b_c;

  static constexpr auto kLanes = Fields(&EdgeReprojectionIntrinsicsOf::uv);

  template <class T>
  bool Evaluate(const View<VertexPose, T>& pose, const View<VertexPointXYZ, T>& point,
                const View<Intrinsics, T>& intrinsics, const Vec<T, 2>& measured, Vec<T, 2>& r,
                Mat<T, 2, 6>* d_r_d_pose, Mat<T, 2, 3>* d_r_d_point,
                Mat<T, 2, kDim>* d_r_d_intrinsics) const {
    const internal::PointInCamera<T> x(pose, point, T_b_c);
    const bool linearize = d_r_d_pose || d_r_d_point;
    Mat<T, 2, 3> d_r_d_c;
    if (!Model::Project(intrinsics.state, x.x_c, r, linearize ? &d_r_d_c : nullptr,
                        d_r_d_intrinsics)) {
      return false;
    }
    if (!internal::HasValue(r)) return false;
    r = r - measured;
    if (linearize) x.Derivatives(pose, d_r_d_c, d_r_d_pose, d_r_d_point);
    return true;
  }
  bool Evaluate(const VertexPose& pose, const VertexPointXYZ& point, const Intrinsics& intrinsics,
                Vector2& r, Jacobian<2, 6>* d_r_d_pose, Jacobian<2, 3>* d_r_d_point,
                Jacobian<2, kDim>* d_r_d_intrinsics) const {
    return internal::EvaluateInDouble(*this, std::tie(pose, point, intrinsics), r, d_r_d_pose,
                                      d_r_d_point, d_r_d_intrinsics);
  }

  /// Two edges on the same vertices are by the same camera if it has the same place in the body.
  [[nodiscard]] bool SameSensor(const EdgeReprojectionIntrinsicsOf& other) const {
    return T_b_c == other.T_b_c;
  }

  /// z of the point in the camera (m).
  [[nodiscard]] double Depth(const VertexPose& pose, const VertexPointXYZ& point,
                             const Intrinsics&) const {
    const Vector3 x_b = pose.pose.R().transpose() * (point.p() - pose.pose.p());
    return T_b_c.R().col(2).dot(x_b - T_b_c.p());
  }

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidateFinite(uv.data(), 2, "observation"); !s.ok()) return s;
    return ValidatePose(T_b_c.data, "extrinsic");
  }
};

/// Intrinsics [f, cx, cy, k1, k2].
using EdgeReprojectionRadial = EdgeReprojectionIntrinsicsOf<IntrinsicsRadial>;
/// Intrinsics [fx, fy, cx, cy, k1, k2, p1, p2].
using EdgeReprojectionRadtan = EdgeReprojectionIntrinsicsOf<IntrinsicsRadtan>;
/// Intrinsics [fx, fy, cx, cy, k1, k2, k3, k4].
using EdgeReprojectionFisheye = EdgeReprojectionIntrinsicsOf<IntrinsicsFisheye>;

template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojectionRadial>{"EdgeReprojectionRadial"};
template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojectionRadtan>{"EdgeReprojectionRadtan"};
template <>
inline constexpr TypeInfo kTypeInfo<EdgeReprojectionFisheye>{"EdgeReprojectionFisheye"};
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeReprojectionRadial> = true;
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeReprojectionRadtan> = true;
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeReprojectionFisheye> = true;
extern template struct internal::EdgeOpsOf<EdgeReprojectionRadial>;
extern template struct internal::EdgeOpsOf<EdgeReprojectionRadtan>;
extern template struct internal::EdgeOpsOf<EdgeReprojectionFisheye>;

}  // namespace glissade
