// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <type_traits>

#include "glissade/base/matrix.h"
#include "glissade/lie/quaternion.h"

namespace glissade {

namespace internal {
/// R x of a unit quaternion and three numbers: products without Eigen's expressions, which cost
/// whoever includes this 0.2 s.
template <int = 0>
Vector3 Rotate(const double* q, const double* x) {
  const Matrix3 R = RotationMatrix(q);
  const auto row = [&](int i) { return R(i, 0) * x[0] + R(i, 1) * x[1] + R(i, 2) * x[2]; };
  return Vector3(row(0), row(1), row(2));
}
}  // namespace internal

/// Rigid transform T_a_b: maps coordinates in frame b to frame a, x_a = R_a_b x_b + p_a_b.
///
/// Seven plain doubles: position p_a_b (m) and the Hamilton unit quaternion q_a_b as x y z w. The
/// quaternion is stored as given; Normalize() if it may be off.
struct Pose {
  double data[7] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0};  ///< px py pz qx qy qz qw

  /// Identity.
  Pose() = default;
  Pose(const Quaternion& q_a_b, const Vector3& p_a_b)
      : data{p_a_b[0], p_a_b[1], p_a_b[2], q_a_b.x(), q_a_b.y(), q_a_b.z(), q_a_b.w()} {}
  /// R_a_b must be a rotation matrix up to rounding.
  template <int = 0>
  Pose(const Matrix3& R_a_b, const Vector3& p_a_b) : Pose(Quaternion(R_a_b), p_a_b) {
    Normalize();
  }

  [[nodiscard]] Eigen::Map<const Vector3> p() const { return Eigen::Map<const Vector3>(data); }
  [[nodiscard]] Eigen::Map<Vector3> p() { return Eigen::Map<Vector3>(data); }

  /// View of the quaternion; coeffs() are x y z w.
  [[nodiscard]] Eigen::Map<const Eigen::Quaterniond> q() const {
    return Eigen::Map<const Eigen::Quaterniond>(data + 3);
  }
  [[nodiscard]] Eigen::Map<Eigen::Quaterniond> q() {
    return Eigen::Map<Eigen::Quaterniond>(data + 3);
  }

  /// Rotation matrix R_a_b.
  template <int = 0>
  [[nodiscard]] Matrix3 R() const {
    return RotationMatrix(data + 3);
  }

  /// T_b_a.
  template <int = 0>
  [[nodiscard]] Pose Inverse() const {
    const double q_b_a[4] = {-data[3], -data[4], -data[5], data[6]};
    const Vector3 p_b_a = internal::Rotate(q_b_a, data);
    Pose inverse;
    for (int i = 0; i < 3; ++i)
      inverse.data[i] = -p_b_a[i];
    for (int i = 0; i < 4; ++i)
      inverse.data[3 + i] = q_b_a[i];
    return inverse;
  }

  /// Scales the quaternion to unit length. A quaternion without direction (zero, or not finite)
  /// stays as it is.
  void Normalize() {
    const double n2 = data[3] * data[3] + data[4] * data[4] + data[5] * data[5] + data[6] * data[6];
    if (!(n2 > 0.0)) return;
    const double scale = 1.0 / std::sqrt(n2);
    for (int i = 3; i < 7; ++i)
      data[i] *= scale;
  }

  /// T_a_c = T_a_b T_b_c.
  template <int = 0>
  friend Pose operator*(const Pose& T_a_b, const Pose& T_b_c) {
    return Pose(Quaternion(T_a_b.q() * T_b_c.q()), T_a_b * Vector3(T_b_c.p()));
  }
  /// x_a = T_a_b x_b.
  template <int = 0>
  friend Vector3 operator*(const Pose& T_a_b, const Vector3& x_b) {
    Vector3 x_a = internal::Rotate(T_a_b.data + 3, x_b.data());
    for (int i = 0; i < 3; ++i)
      x_a[i] += T_a_b.data[i];
    return x_a;
  }

  friend bool operator==(const Pose&, const Pose&) = default;
};

static_assert(sizeof(Pose) == 7 * sizeof(double) && std::is_trivially_copyable_v<Pose>);

}  // namespace glissade
