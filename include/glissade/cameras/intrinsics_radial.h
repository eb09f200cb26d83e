// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/cameras/identity.h"
#include "glissade/cameras/intrinsics.h"

namespace glissade {

/// One focal length and radial distortion, [f, cx, cy, k1, k2] (px): COLMAP's RADIAL, with k2 = 0
/// its SIMPLE_RADIAL, with both 0 its SIMPLE_PINHOLE. With (x, y) normalized and n = x^2 + y^2:
///     (u, v) = f (1 + k1 n + k2 n^2) (x, y) + (cx, cy).
/// Evaluated behind the camera as well; no value at z = 0.
struct IntrinsicsRadial {
  static constexpr int kDim = 5;

  template <class T>
  static bool Project(const T* intrinsics, const Vec<T, 3>& p_c, Vec<T, 2>& uv,
                      Mat<T, 2, 3>* d_uv_d_p, Mat<T, 2, 5>* d_uv_d_intrinsics) {
    Vec<T, 2> xy;
    if (!CameraIdentity().Project(p_c, xy, d_uv_d_p)) return false;
    const T f = intrinsics[0], k1 = intrinsics[3], k2 = intrinsics[4];
    const T x = xy[0], y = xy[1];
    const T n = x * x + y * y;
    const T distortion = T(1.0) + n * (k1 + k2 * n);
    uv = {{f * distortion * x + intrinsics[1], f * distortion * y + intrinsics[2]}};
    if (d_uv_d_p != nullptr) {
      const T slope = T(2.0) * (k1 + T(2.0) * k2 * n);
      const T off = f * slope * x * y;
      const Mat<T, 2, 2> d_uv_d_xy = {{f * (distortion + slope * x * x), off,  //
                                       off, f * (distortion + slope * y * y)}};
      *d_uv_d_p = d_uv_d_xy * *d_uv_d_p;
    }
    if (d_uv_d_intrinsics != nullptr) {
      *d_uv_d_intrinsics = {{distortion * x, T(1.0), T(0.0), f * n * x, f * n * n * x,  //
                             distortion * y, T(0.0), T(1.0), f * n * y, f * n * n * y}};
    }
    return true;
  }
};

static_assert(IntrinsicsModel<IntrinsicsRadial>);

}  // namespace glissade
