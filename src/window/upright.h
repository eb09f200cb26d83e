// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/base/matrix.h"
#include "glissade/lie/so3.h"

namespace glissade::internal {

/// R_W_B with R_W_B u = z and yaw 0, of a unit vector u: pitch, then roll.
inline Matrix3 UprightWithoutYaw(const Vector3& u) {
  const double roll = std::atan2(u[1], u[2]);
  const double pitch = std::atan2(-u[0], std::hypot(u[1], u[2]));
  return so3::Exp(Vector3(0.0, pitch, 0.0)) * so3::Exp(Vector3(roll, 0.0, 0.0));
}

}  // namespace glissade::internal
