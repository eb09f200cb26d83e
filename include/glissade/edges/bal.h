// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/base/validate.h"
#include "glissade/edges/concept.h"
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

  template <int = 0>
  bool Evaluate(const VertexCameraBal& camera, const VertexPointXYZ& point, Vector2& r,
                Jacobian<2, 9>* d_r_d_camera, Jacobian<2, 3>* d_r_d_point) const {
    const double* c = camera.data;
    const Vector3 omega(c[0], c[1], c[2]);
    const double f = c[6], k1 = c[7], k2 = c[8];
    // d(Exp(w) X)/dw = -[R X]x Jl(w); regular at w = 0.
    Matrix3 R, Jl;
    so3::ExpAndJl(omega, R, Jl);
    const Vector3 rotated = R * point.p();
    const Vector3 x_c = rotated + Eigen::Map<const Vector3>(c + 3);
    if (x_c[2] == 0.0) return false;

    const double minus_inv_z = -1.0 / x_c[2];
    const Vector2 p = minus_inv_z * x_c.head<2>();
    const double n = p.squaredNorm();
    const double distortion = 1.0 + n * (k1 + k2 * n);
    r = f * distortion * p - uv;
    if (!std::isfinite(r[0] + r[1])) return false;
    if (!d_r_d_camera && !d_r_d_point) return true;

    // d r / d p = f (distortion I + slope p p'), then through p = -P.xy / P.z.
    const double slope = 2.0 * (k1 + 2.0 * k2 * n);
    const double off = f * slope * p[0] * p[1];
    const double dxx = f * (distortion + slope * p[0] * p[0]);
    const double dyy = f * (distortion + slope * p[1] * p[1]);
    Matrix<2, 3> d_r_d_c;
    d_r_d_c << dxx, off, dxx * p[0] + off * p[1],  //
        off, dyy, off * p[0] + dyy * p[1];
    d_r_d_c *= minus_inv_z;

    if (d_r_d_camera) {
      for (int row = 0; row < 2; ++row) {
        d_r_d_camera->row(row).head<3>() =
            rotated.cross(Vector3(d_r_d_c.row(row))).transpose() * Jl;
      }
      d_r_d_camera->middleCols<3>(3) = d_r_d_c;
      d_r_d_camera->col(6) = distortion * p;
      d_r_d_camera->col(7) = f * n * p;
      d_r_d_camera->col(8) = f * n * n * p;
    }
    if (d_r_d_point) d_r_d_point->noalias() = d_r_d_c * R;
    return true;
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

}  // namespace glissade
