// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>
#include "glissade/base/matrix.h"

#include "glissade/cameras/concept.h"

namespace glissade {

/// The ideal camera: image coordinates are the normalized coordinates (x/z, y/z) of the undistorted
/// ray. Evaluated behind the camera as well; no value at z = 0.
struct CameraIdentity {
  template <class T>
  bool Project(const Vec<T, 3>& p_c, Vec<T, 2>& uv, Mat<T, 2, 3>* d_uv_d_p) const {
    if constexpr (std::is_same_v<T, double>) {
      if (p_c[2] == 0.0) return false;  // in packs the quotient tells
    }
    const T inv_z = T(1.0) / p_c[2];
    uv = {{p_c[0] * inv_z, p_c[1] * inv_z}};
    if (d_uv_d_p != nullptr) {
      *d_uv_d_p = {{inv_z, T(0.0), -uv[0] * inv_z, T(0.0), inv_z, -uv[1] * inv_z}};
    }
    return true;
  }
  bool Project(const Vector3& p_c, Vector2& uv, Matrix<2, 3>* d_uv_d_p) const {
    return internal::ProjectEigen(*this, p_c, uv, d_uv_d_p);
  }

  bool Unproject(const Vector2& uv, Vector2& xy, Matrix2* d_xy_d_uv) const {
    xy = uv;
    if (d_xy_d_uv != nullptr) d_xy_d_uv->setIdentity();
    return true;
  }

  friend bool operator==(const CameraIdentity&, const CameraIdentity&) = default;
};

static_assert(CameraModel<CameraIdentity>);

}  // namespace glissade
