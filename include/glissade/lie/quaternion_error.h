// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/matrix.h"
#include "glissade/lie/quaternion.h"
#include "glissade/lie/so3.h"

/// \file
/// The orientation error 2 vec(e) of a unit quaternion e, its sign chosen so that w >= 0: equals
/// Log(e) to second order near the identity and is cheaper. Its length is 2 sin(angle / 2).
namespace glissade {

/// e or -e, whichever has w >= 0.
template <int = 0>
Quaternion WithPositiveW(const Quaternion& e) {
  return e.w() < 0.0 ? Quaternion(-e.w(), -e.x(), -e.y(), -e.z()) : e;
}

/// d 2 vec(e Exp(d)) / d d at d = 0.
template <int = 0>
Matrix3 TwoVecRightJacobian(const Quaternion& e) {
  Matrix3 m = so3::Hat(e.vec());
  m.diagonal().array() += e.w();
  return m;
}

/// d 2 vec(Exp(d) e) / d d at d = 0.
template <int = 0>
Matrix3 TwoVecLeftJacobian(const Quaternion& e) {
  return TwoVecRightJacobian(e).transpose();
}

}  // namespace glissade
