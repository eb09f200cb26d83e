// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/matrix.h"
#include "glissade/base/validate.h"
#include "glissade/lie/quaternion.h"

namespace glissade {

/// IMU samples between two frames i and j, integrated in the body frame of i without gravity, at
/// the biases ba_lin and bg_lin (C. Forster et al., "On-Manifold Preintegration for Real-Time
/// Visual-Inertial Odometry", TRO 2017, Sec. VI). First-order bias corrections: with
/// dba = ba - ba_lin, dbg = bg - bg_lin,
///     p: dp + dp_dba dba + dp_dbg dbg,   q: dq Exp(dq_dbg dbg),   v: dv + dv_dba dba + dv_dbg dbg.
/// The uncertainty is the edge's information and not kept here.
struct PreintegratedImu {
  double dt = 0.0;                         ///< s
  Vector3 dp = Vector3::Zero();            ///< m, axes of body i
  Quaternion dq = Quaternion::Identity();  ///< body j in body i
  Vector3 dv = Vector3::Zero();            ///< m/s, axes of body i
  Vector3 ba_lin = Vector3::Zero();        ///< m/s^2
  Vector3 bg_lin = Vector3::Zero();        ///< rad/s
  Matrix3 dp_dba = Matrix3::Zero();        ///< s^2
  Matrix3 dp_dbg = Matrix3::Zero();        ///< m s
  Matrix3 dq_dbg = Matrix3::Zero();        ///< s; tangent at the right of dq
  Matrix3 dv_dba = Matrix3::Zero();        ///< s
  Matrix3 dv_dbg = Matrix3::Zero();        ///< m

  [[nodiscard]] Status Validate() const {
    if (Status s = ValidatePositive(dt, "IMU interval"); !s.ok()) return s;
    if (Status s = ValidateFinite(dp.data(), 3, "preintegrated position"); !s.ok()) return s;
    if (Status s = ValidateQuaternion(dq.coeffs().data(), "preintegrated rotation"); !s.ok()) {
      return s;
    }
    if (Status s = ValidateFinite(dv.data(), 3, "preintegrated velocity"); !s.ok()) return s;
    if (Status s = ValidateFinite(ba_lin.data(), 3, "accelerometer bias"); !s.ok()) return s;
    if (Status s = ValidateFinite(bg_lin.data(), 3, "gyroscope bias"); !s.ok()) return s;
    for (const Matrix3* m : {&dp_dba, &dp_dbg, &dq_dbg, &dv_dba, &dv_dbg}) {
      if (Status s = ValidateFinite(m->data(), 9, "IMU bias Jacobian"); !s.ok()) return s;
    }
    return {};
  }
};

}  // namespace glissade
