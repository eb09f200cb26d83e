// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "glissade/base/matrix.h"

namespace glissade {

/// Hamilton quaternion, stored x y z w, without alignment requirement (see base/matrix.h).
using Quaternion = Eigen::Quaternion<double, Eigen::DontAlign>;

/// Rotation matrix of a unit quaternion given as x y z w.
template <int = 0>
Matrix3 RotationMatrix(const double q[4]) {
  const double x2 = 2.0 * q[0], y2 = 2.0 * q[1], z2 = 2.0 * q[2];
  const double xx = q[0] * x2, yy = q[1] * y2, zz = q[2] * z2;
  const double xy = q[0] * y2, xz = q[0] * z2, yz = q[1] * z2;
  const double wx = q[3] * x2, wy = q[3] * y2, wz = q[3] * z2;
  const double rows[9] = {1.0 - (yy + zz), xy - wz,         xz + wy,  //
                          xy + wz,         1.0 - (xx + zz), yz - wx,  //
                          xz - wy,         yz + wx,         1.0 - (xx + yy)};
  return Matrix3(rows);
}

}  // namespace glissade
