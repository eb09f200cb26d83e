// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string_view>

#include "glissade/base/matrix.h"
#include "glissade/lie/pose.h"
#include "glissade/lie/so3.h"
#include "glissade/sim/bspline.h"

namespace glissade::sim {

enum class TrajectoryKind {
  kSine,  ///< along x, swinging in y; the camera looks along y
  kArc,   ///< a third of a circle; the camera looks outward
  kRec,   ///< once around a rectangle of 3 : 2; the camera looks along y
};

/// "sine", "arc", "rec".
std::string_view ToString(TrajectoryKind kind);

/// A flight in six degrees of freedom: quintic B-splines of position and of yaw, pitch and roll,
/// R_W_B = Rz(yaw) Ry(pitch) Rx(roll), body x forward, y left, z up. Velocities, accelerations and
/// angular rates are their derivatives.
class Trajectory {
 public:
  Trajectory() = default;
  /// About `length` metres at about `speed` m/s. Control points lie on the formula, every 0.125 s;
  /// positive arguments.
  Trajectory(TrajectoryKind kind, double length, double speed, int laps = 1);

  [[nodiscard]] double Duration() const { return position_.Duration(); }
  [[nodiscard]] Pose PoseAt(double t) const { return Pose(RotationAt(t), position_.Evaluate(t)); }
  /// R_W_B.
  [[nodiscard]] Matrix3 RotationAt(double t) const {
    const Vector3 a = angles_.Evaluate(t);
    return so3::Exp(Vector3(0, 0, a[0])) * so3::Exp(Vector3(0, a[1], 0)) *
           so3::Exp(Vector3(a[2], 0, 0));
  }
  [[nodiscard]] Vector3 VelocityAt(double t) const { return position_.Evaluate(t, 1); }  ///< in W
  [[nodiscard]] Vector3 AccelerationAt(double t) const { return position_.Evaluate(t, 2); }
  /// Of the body, in body axes (rad/s).
  [[nodiscard]] Vector3 AngularRateAt(double t) const {
    const Vector3 a = angles_.Evaluate(t), d = angles_.Evaluate(t, 1);
    const double sp = std::sin(a[1]), cp = std::cos(a[1]);
    const double sr = std::sin(a[2]), cr = std::cos(a[2]);
    return {d[2] - d[0] * sp, d[1] * cr + d[0] * cp * sr, -d[1] * sr + d[0] * cp * cr};
  }

 private:
  BSpline position_;
  BSpline angles_;  // yaw, pitch, roll
};

}  // namespace glissade::sim
