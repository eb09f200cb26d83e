// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"
#include "glissade/cameras/concept.h"
#include "glissade/cameras/identity.h"

namespace glissade {

/// Pinhole camera without distortion: u = fx x/z + cx, v = fy y/z + cy (px). Evaluated behind the
/// camera as well; no value at z = 0.
struct CameraPinhole {
  double fx = 1.0, fy = 1.0, cx = 0.0, cy = 0.0;

  template <class T>
  bool Project(const Vec<T, 3>& p_c, Vec<T, 2>& uv, Mat<T, 2, 3>* d_uv_d_p) const {
    if (!CameraIdentity().Project(p_c, uv, d_uv_d_p)) return false;
    uv = {{T(fx) * uv[0] + T(cx), T(fy) * uv[1] + T(cy)}};
    for (int c = 0; d_uv_d_p != nullptr && c < 3; ++c) {
      (*d_uv_d_p)(0, c) *= T(fx);
      (*d_uv_d_p)(1, c) *= T(fy);
    }
    return true;
  }
  bool Project(const Vector3& p_c, Vector2& uv, Matrix<2, 3>* d_uv_d_p) const {
    return internal::ProjectEigen(*this, p_c, uv, d_uv_d_p);
  }

  bool Unproject(const Vector2& uv, Vector2& xy, Matrix2* d_xy_d_uv) const {
    xy[0] = (uv[0] - cx) / fx;
    xy[1] = (uv[1] - cy) / fy;
    if (d_xy_d_uv != nullptr) *d_xy_d_uv << 1.0 / fx, 0.0, 0.0, 1.0 / fy;
    return true;
  }

  /// Finite, with positive focal lengths.
  [[nodiscard]] Status Validate() const {
    if (Status s = ValidatePositive(fx, "focal length fx"); !s.ok()) return s;
    if (Status s = ValidatePositive(fy, "focal length fy"); !s.ok()) return s;
    if (Status s = ValidateFinite(&cx, 1, "principal point cx"); !s.ok()) return s;
    return ValidateFinite(&cy, 1, "principal point cy");
  }

  friend bool operator==(const CameraPinhole&, const CameraPinhole&) = default;
};

static_assert(CameraModel<CameraPinhole>);

}  // namespace glissade
