// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/cameras/identity.h"
#include "glissade/cameras/intrinsics.h"

namespace glissade {

/// Two focal lengths and radial-tangential distortion, [fx, fy, cx, cy, k1, k2, p1, p2] (px):
/// CameraRadtan with k3 = 0; COLMAP's OPENCV, without distortion its PINHOLE.
/// Evaluated behind the camera as well; no value at z = 0.
struct IntrinsicsRadtan {
  static constexpr int kDim = 8;

  template <class T>
  static bool Project(const T* intrinsics, const Vec<T, 3>& p_c, Vec<T, 2>& uv,
                      Mat<T, 2, 3>* d_uv_d_p, Mat<T, 2, 8>* d_uv_d_intrinsics) {
    Vec<T, 2> xy;
    if (!CameraIdentity().Project(p_c, xy, d_uv_d_p)) return false;
    const T fx = intrinsics[0], fy = intrinsics[1], k1 = intrinsics[4], k2 = intrinsics[5],
            p1 = intrinsics[6], p2 = intrinsics[7];
    const T x = xy[0], y = xy[1];
    const T xx = x * x, yy = y * y, n = xx + yy, two_xy = T(2.0) * x * y;
    const T distortion = T(1.0) + n * (k1 + k2 * n);
    const T x_d = x * distortion + p1 * two_xy + p2 * (n + T(2.0) * xx);
    const T y_d = y * distortion + p1 * (n + T(2.0) * yy) + p2 * two_xy;
    uv = {{fx * x_d + intrinsics[2], fy * y_d + intrinsics[3]}};
    if (d_uv_d_p != nullptr) {
      const T slope = T(2.0) * (k1 + T(2.0) * k2 * n);
      const T off = slope * x * y + T(2.0) * (p1 * x + p2 * y);
      const T dxx = distortion + slope * xx + T(2.0) * p1 * y + T(6.0) * p2 * x;
      const T dyy = distortion + slope * yy + T(6.0) * p1 * y + T(2.0) * p2 * x;
      const Mat<T, 2, 2> d_uv_d_xy = {{fx * dxx, fx * off, fy * off, fy * dyy}};
      *d_uv_d_p = d_uv_d_xy * *d_uv_d_p;
    }
    if (d_uv_d_intrinsics != nullptr) {
      const T zero(0.0), one(1.0);
      *d_uv_d_intrinsics = {{x_d, zero, one, zero, fx * n * x, fx * n * n * x, fx * two_xy,
                             fx * (n + T(2.0) * xx),  //
                             zero, y_d, zero, one, fy * n * y, fy * n * n * y,
                             fy * (n + T(2.0) * yy), fy * two_xy}};
    }
    return true;
  }
};

static_assert(IntrinsicsModel<IntrinsicsRadtan>);

}  // namespace glissade
