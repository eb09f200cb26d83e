// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/base/matrix.h"
#include "glissade/lie/quaternion.h"

/// \file
/// The rotation group. phi is a rotation vector (axis times angle, rad). Source: J. Solà,
/// J. Deray, D. Atchuthan, "A micro Lie theory for state estimation in robotics" (2018), Appendix
/// B.
///
/// All functions are accurate to a few rounding errors from phi = 0 to |phi| = pi and beyond,
/// except the inverse Jacobians, which do not exist at |phi| = 2 pi. NaN in, NaN out.
namespace glissade::so3 {

namespace internal {

// Below this squared angle power series are used: there they are exact to rounding, while the
// closed forms have begun to cancel. They also spare the optimizer's small steps every sin and cos.
inline constexpr double kSeriesLimit = 0.25;

/// sin(t) / t of x = t^2.
inline double SinOverT(double x) {
  if (x < kSeriesLimit) {
    constexpr double c1 = 1.0 / 6, c2 = c1 / 20, c3 = c2 / 42, c4 = c3 / 72, c5 = c4 / 110,
                     c6 = c5 / 156;
    return 1 - x * (c1 - x * (c2 - x * (c3 - x * (c4 - x * (c5 - x * c6)))));
  }
  const double t = std::sqrt(x);
  return std::sin(t) / t;
}

/// (1 - cos(t)) / t^2 of x = t^2.
inline double OneMinusCosOverT2(double x) {
  if (x < kSeriesLimit) {
    constexpr double c0 = 0.5, c1 = c0 / 12, c2 = c1 / 30, c3 = c2 / 56, c4 = c3 / 90,
                     c5 = c4 / 132, c6 = c5 / 182;
    return c0 - x * (c1 - x * (c2 - x * (c3 - x * (c4 - x * (c5 - x * c6)))));
  }
  const double s = std::sin(0.5 * std::sqrt(x));  // 2 sin^2(t/2) does not cancel
  return 2.0 * s * s / x;
}

/// (t - sin(t)) / t^3 of x = t^2.
inline double TMinusSinOverT3(double x) {
  if (x < kSeriesLimit) {
    constexpr double c0 = 1.0 / 6, c1 = c0 / 20, c2 = c1 / 42, c3 = c2 / 72, c4 = c3 / 110,
                     c5 = c4 / 156, c6 = c5 / 210;
    return c0 - x * (c1 - x * (c2 - x * (c3 - x * (c4 - x * (c5 - x * c6)))));
  }
  const double t = std::sqrt(x);
  return (t - std::sin(t)) / (x * t);
}

/// (1 - (t/2) cot(t/2)) / t^2 of x = t^2. In half angles, so that t = pi is nothing special.
inline double InverseJacobianCoefficient(double x) {
  if (x < kSeriesLimit) {
    constexpr double c0 = 1.0 / 12, c1 = 1.0 / 720, c2 = 1.0 / 30240, c3 = 1.0 / 1209600,
                     c4 = 1.0 / 47900160, c5 = 691.0 / 1307674368000.0, c6 = 1.0 / 74724249600.0,
                     c7 = 3617.0 / 10670622842880000.0;
    return c0 + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * (c5 + x * (c6 + x * c7))))));
  }
  const double half = 0.5 * std::sqrt(x);
  return (1.0 - half * std::cos(half) / std::sin(half)) / x;
}

/// I + a [phi]x + b [phi]x^2.
inline Matrix3 Polynomial(const Vector3& phi, double a, double b) {
  const double x = phi[0], y = phi[1], z = phi[2];
  const double bxy = b * x * y, bxz = b * x * z, byz = b * y * z;
  const double ax = a * x, ay = a * y, az = a * z;
  Matrix3 m;
  m << 1.0 - b * (y * y + z * z), bxy - az, bxz + ay,  //
      bxy + az, 1.0 - b * (x * x + z * z), byz - ax,   //
      bxz - ay, byz + ax, 1.0 - b * (x * x + y * y);
  return m;
}

}  // namespace internal

/// [v]x, the matrix with [v]x u = v x u.
inline Matrix3 Hat(const Vector3& v) {
  Matrix3 m;
  m << 0.0, -v[2], v[1],  //
      v[2], 0.0, -v[0],   //
      -v[1], v[0], 0.0;
  return m;
}

/// Rotation matrix of a rotation vector (Rodrigues' formula).
inline Matrix3 Exp(const Vector3& phi) {
  const double x = phi.squaredNorm();
  return internal::Polynomial(phi, internal::SinOverT(x), internal::OneMinusCosOverT2(x));
}

/// Unit quaternion of a rotation vector; w >= 0 for |phi| <= pi.
inline Quaternion ExpQuaternion(const Vector3& phi) {
  const double x = 0.25 * phi.squaredNorm();  // square of the half angle
  const double s = 0.5 * internal::SinOverT(x);
  // cos(t) = 1 - 2 sin^2(t/2), whichever way the sine comes about.
  const double w = x < internal::kSeriesLimit ? 1.0 - x * internal::OneMinusCosOverT2(x)
                                              : std::cos(std::sqrt(x));
  return Quaternion(w, s * phi[0], s * phi[1], s * phi[2]);
}

/// Rotation vector of a quaternion, 0 <= |phi| <= pi. q and -q give the same phi, except at exactly
/// w = 0, where both +-phi are valid. Insensitive to the norm of q; q = 0 gives 0.
inline Vector3 Log(const Quaternion& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double w = sign * q.w();
  const Vector3 v(sign * q.x(), sign * q.y(), sign * q.z());
  const double n2 = v.squaredNorm();
  const double w2 = w * w;
  double scale;  // angle / |v|
  if (n2 < 1e-6 * w2) {
    // 2 atan(n / w) / n. Good to rounding, and without 0 / 0 where n2 underflows.
    const double x = n2 / w2;
    scale = 2.0 / w * (1.0 - x * (1.0 / 3 - x * (1.0 / 5 - x * (1.0 / 7))));
  } else {
    const double n = std::sqrt(n2);
    scale = n > 0.0 ? 2.0 * std::atan2(n, w) / n : 0.0;
    if (std::isnan(n)) scale = n;
  }
  return scale * v;
}

/// Rotation vector of a rotation matrix, 0 <= |phi| <= pi, through the quaternion's largest
/// component, so that it loses no digits near 0 or near pi.
inline Vector3 Log(const Matrix3& R) {
  return Log(Quaternion(R));
}

/// Right Jacobian: Exp(phi + d) = Exp(phi) Exp(Jr(phi) d) to first order in d.
inline Matrix3 Jr(const Vector3& phi) {
  const double x = phi.squaredNorm();
  return internal::Polynomial(phi, -internal::OneMinusCosOverT2(x), internal::TMinusSinOverT3(x));
}

/// Left Jacobian: Exp(phi + d) = Exp(Jl(phi) d) Exp(phi) to first order in d.
inline Matrix3 Jl(const Vector3& phi) {
  const double x = phi.squaredNorm();
  return internal::Polynomial(phi, internal::OneMinusCosOverT2(x), internal::TMinusSinOverT3(x));
}

/// Inverse right Jacobian: Log(Exp(phi) Exp(d)) = phi + JrInverse(phi) d to first order in d.
inline Matrix3 JrInverse(const Vector3& phi) {
  return internal::Polynomial(phi, 0.5, internal::InverseJacobianCoefficient(phi.squaredNorm()));
}

/// Inverse left Jacobian: Log(Exp(d) Exp(phi)) = phi + JlInverse(phi) d to first order in d.
inline Matrix3 JlInverse(const Vector3& phi) {
  return internal::Polynomial(phi, -0.5, internal::InverseJacobianCoefficient(phi.squaredNorm()));
}

}  // namespace glissade::so3
