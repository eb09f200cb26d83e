// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/cameras/intrinsics.h"

namespace glissade {

/// Fisheye, [fx, fy, cx, cy, k1, k2, k3, k4] (px): the model of CameraKannalaBrandt, COLMAP's
/// OPENCV_FISHEYE. Rays of up to 180 degrees off the axis have an image; the backward axis itself
/// has none.
struct IntrinsicsFisheye {
  static constexpr int kDim = 8;

  template <class T>
  static bool Project(const T* intrinsics, const Vec<T, 3>& p_c, Vec<T, 2>& uv,
                      Mat<T, 2, 3>* d_uv_d_p, Mat<T, 2, 8>* d_uv_d_intrinsics) {
    using std::atan2;
    using std::sqrt;
    const T fx = intrinsics[0], fy = intrinsics[1];
    const T* k = intrinsics + 4;
    const T x = p_c[0], y = p_c[1], z = p_c[2];
    const T r2 = x * x + y * y;
    // s = theta_d / r, A = (d theta_d / dr - s) / r^2, slope = d theta_d / d theta,
    // n = theta^2, t = theta / r.
    T s, A, slope, n, t;
    if ((z > T(0.0)) & (r2 < T(1e-10) * z * z)) {
      n = r2 / (z * z);
      t = T(1.0) / z;
      const T cubic = k[0] - T(1.0 / 3);
      s = (T(1.0) + cubic * n) * t;
      A = T(2.0) * cubic * t * t * t;
      slope = T(1.0) + T(3.0) * k[0] * n;
    } else {
      const T r = sqrt(r2);
      if (!(r > T(0.0))) return false;
      const T theta = atan2(r, z);
      n = theta * theta;
      t = theta / r;
      s = t * (T(1.0) + n * (k[0] + n * (k[1] + n * (k[2] + n * k[3]))));
      slope = T(1.0) +
              n * (T(3.0) * k[0] + n * (T(5.0) * k[1] + n * (T(7.0) * k[2] + n * T(9.0) * k[3])));
      A = (slope * z / (r2 + z * z) - s) / r2;
    }
    uv = {{fx * s * x + intrinsics[2], fy * s * y + intrinsics[3]}};
    if (d_uv_d_p != nullptr) {
      const T d_z = -slope / (r2 + z * z);
      *d_uv_d_p = {{fx * (s + A * x * x), fx * A * x * y, fx * d_z * x,  //
                    fy * A * x * y, fy * (s + A * y * y), fy * d_z * y}};
    }
    if (d_uv_d_intrinsics != nullptr) {
      const T zero(0.0), one(1.0);
      Mat<T, 2, 8>& d = *d_uv_d_intrinsics;
      d = {{s * x, zero, one, zero, zero, zero, zero, zero,  //
            zero, s * y, zero, one, zero, zero, zero, zero}};
      T power = t;
      for (int i = 0; i < 4; ++i) {
        power *= n;
        d(0, 4 + i) = fx * power * x;
        d(1, 4 + i) = fy * power * y;
      }
    }
    return true;
  }
};

static_assert(IntrinsicsModel<IntrinsicsFisheye>);

}  // namespace glissade
