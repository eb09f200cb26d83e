// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/base/validate.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/edges/lanes.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/point_xyz.h"

namespace glissade {

/// Observation in a "Bundle Adjustment in the Large" problem (S. Agarwal et al., ECCV 2010; format
/// at grail.cs.washington.edu/projects/bal):
///     P = R X + t,   p = -P.xy / P.z,   r = f (1 + k1 |p|^2 + k2 |p|^4) p - uv   (px).
/// The camera looks along its -z axis. Points behind it are evaluated all the same; no value where
/// P.z = 0.
struct EdgeBal {
  using Vertices = VertexList<VertexCameraBal, VertexPointXYZ>;
  static constexpr int kResidualDim = 2;
  static constexpr bool kIsObservation = true;

  Vector2 uv = Vector2::Zero();  ///< px, origin at the image centre

  static constexpr auto kLanes = Fields(&EdgeBal::uv);

  template <class T>
  bool Evaluate(const View<VertexCameraBal, T>& camera, const View<VertexPointXYZ, T>& point,
                const Vec<T, 2>& measured, Vec<T, 2>& r, Mat<T, 2, 9>* d_r_d_camera,
                Mat<T, 2, 3>* d_r_d_point) const {
    // d(Exp(w) X)/dw = -[R X]x Jl(w); regular at w = 0.
    const Vec<T, 3> rotated = camera.R * point.p;
    const Vec<T, 3> x_c = rotated + camera.t;
    if constexpr (std::is_same_v<T, double>) {
      if (x_c[2] == 0.0) return false;  // in packs the quotient tells
    }
    const T minus_inv_z = T(-1.0) / x_c[2];
    const Vec<T, 2> p = {{minus_inv_z * x_c[0], minus_inv_z * x_c[1]}};
    const T n = p[0] * p[0] + p[1] * p[1];
    const T distortion = T(1.0) + n * (camera.k1 + camera.k2 * n);
    r = camera.f * distortion * p - measured;
    if (!internal::HasValue(r)) return false;
    if (!d_r_d_camera && !d_r_d_point) return true;

    // d r / d p = f (distortion I + slope p p'), then through p = -P.xy / P.z.
    const T slope = T(2.0) * (camera.k1 + T(2.0) * camera.k2 * n);
    const T off = camera.f * slope * p[0] * p[1];
    const T dxx = camera.f * (distortion + slope * p[0] * p[0]);
    const T dyy = camera.f * (distortion + slope * p[1] * p[1]);
    const Mat<T, 2, 3> d_r_d_c = minus_inv_z * Mat<T, 2, 3>{{dxx, off, dxx * p[0] + off * p[1],  //
                                                             off, dyy, off * p[0] + dyy * p[1]}};
    if (d_r_d_camera) {
      for (int row = 0; row < 2; ++row) {
        d_r_d_camera->Set(row, 0, Cross(rotated, d_r_d_c.Row(row)) * camera.Jl);
        (*d_r_d_camera)(row, 6) = distortion * p[row];
        (*d_r_d_camera)(row, 7) = camera.f * n * p[row];
        (*d_r_d_camera)(row, 8) = camera.f * n * n * p[row];
      }
      d_r_d_camera->Set(0, 3, d_r_d_c);
    }
    if (d_r_d_point) *d_r_d_point = d_r_d_c * camera.R;
    return true;
  }
  bool Evaluate(const VertexCameraBal& camera, const VertexPointXYZ& point, Vector2& r,
                Jacobian<2, 9>* d_r_d_camera, Jacobian<2, 3>* d_r_d_point) const {
    return internal::EvaluateInDouble(*this, std::tie(camera, point), r, d_r_d_camera, d_r_d_point);
  }

  /// A BAL vertex is one camera.
  [[nodiscard]] bool SameSensor(const EdgeBal&) const { return true; }

  /// Distance along the viewing direction, -P.z.
  template <int = 0>
  [[nodiscard]] double Depth(const VertexCameraBal& camera, const VertexPointXYZ& point) const {
    const double* c = camera.data;
    return -(so3::Exp(Vector3(c[0], c[1], c[2])).row(2).dot(point.p().transpose()) + c[5]);
  }

  [[nodiscard]] Status Validate() const { return ValidateFinite(uv.data(), 2, "observation"); }
};
template <>
inline constexpr bool internal::kLibraryEvaluates<EdgeBal> = true;
extern template struct internal::EdgeOpsOf<EdgeBal>;

}  // namespace glissade
