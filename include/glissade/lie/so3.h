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
///
/// They are templates (base/matrix.h) to spare compile time; none has a parameter to give.
namespace glissade::so3 {

namespace internal {

// Below this squared angle power series are used: there they are exact to rounding, while the
// closed forms have begun to cancel. They also spare the optimizer's small steps every sin and cos.
inline constexpr double kSeriesLimit = 0.25;

/// Coefficients of x = t^2, t the angle: Exp is I + a [phi]x + b [phi]x^2, its Jacobians are
/// I +- b [phi]x + c [phi]x^2.
struct Coefficients {
  double a;  ///< sin(t) / t
  double b;  ///< (1 - cos(t)) / t^2
  double c;  ///< (t - sin(t)) / t^3
};

/// 1/n! - x/(n+2)! + x^2/(n+4)! - ..., for x < kSeriesLimit.
template <int N>
double FactorialSeries(double x) {
  constexpr double c0 = [] {
    double factorial = 1.0;
    for (int i = 2; i <= N; ++i)
      factorial *= i;
    return 1.0 / factorial;
  }();
  constexpr double c1 = c0 / ((N + 1) * (N + 2)), c2 = c1 / ((N + 3) * (N + 4)),
                   c3 = c2 / ((N + 5) * (N + 6)), c4 = c3 / ((N + 7) * (N + 8)),
                   c5 = c4 / ((N + 9) * (N + 10)), c6 = c5 / ((N + 11) * (N + 12));
  return c0 - x * (c1 - x * (c2 - x * (c3 - x * (c4 - x * (c5 - x * c6)))));
}

inline Coefficients CoefficientsAt(double x) {
  if (x < kSeriesLimit)
    return {FactorialSeries<1>(x), FactorialSeries<2>(x), FactorialSeries<3>(x)};
  // In half angles: 2 sin^2(t/2) does not cancel, and one call of sincos serves all three.
  const double t = std::sqrt(x);
  const double s = std::sin(0.5 * t), a = 2.0 * s * std::cos(0.5 * t) / t;
  return {a, 2.0 * s * s / x, (1.0 - a) / x};
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
template <int = 0>
Matrix3 Polynomial(const Vector3& phi, double a, double b) {
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
template <int = 0>
Matrix3 Hat(const Vector3& v) {
  Matrix3 m;
  m << 0.0, -v[2], v[1],  //
      v[2], 0.0, -v[0],   //
      -v[1], v[0], 0.0;
  return m;
}

/// Rotation matrix of a rotation vector (Rodrigues' formula).
template <int = 0>
Matrix3 Exp(const Vector3& phi) {
  const internal::Coefficients k = internal::CoefficientsAt(phi.squaredNorm());
  return internal::Polynomial(phi, k.a, k.b);
}

/// Unit quaternion of a rotation vector; w >= 0 for |phi| <= pi.
template <int = 0>
Quaternion ExpQuaternion(const Vector3& phi) {
  const double x = 0.25 * phi.squaredNorm();  // square of the half angle
  double w, s;
  if (x < internal::kSeriesLimit) {
    w = 1.0 - x * internal::FactorialSeries<2>(x);
    s = 0.5 * internal::FactorialSeries<1>(x);
  } else {
    const double half = std::sqrt(x);
    w = std::cos(half);
    s = 0.5 * std::sin(half) / half;
  }
  return Quaternion(w, s * phi[0], s * phi[1], s * phi[2]);
}

/// Rotation vector of a quaternion, 0 <= |phi| <= pi. q and -q give the same phi, except at exactly
/// w = 0, where both +-phi are valid. Insensitive to the norm of q; q = 0 gives 0.
template <int = 0>
Vector3 Log(const Quaternion& q) {
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
template <int = 0>
Vector3 Log(const Matrix3& R) {
  return Log(Quaternion(R));
}

/// Right Jacobian: Exp(phi + d) = Exp(phi) Exp(Jr(phi) d) to first order in d.
template <int = 0>
Matrix3 Jr(const Vector3& phi) {
  const internal::Coefficients k = internal::CoefficientsAt(phi.squaredNorm());
  return internal::Polynomial(phi, -k.b, k.c);
}

/// Left Jacobian: Exp(phi + d) = Exp(Jl(phi) d) Exp(phi) to first order in d.
template <int = 0>
Matrix3 Jl(const Vector3& phi) {
  const internal::Coefficients k = internal::CoefficientsAt(phi.squaredNorm());
  return internal::Polynomial(phi, k.b, k.c);
}

/// Exp(phi) and Jl(phi) for the price of one.
template <int = 0>
void ExpAndJl(const Vector3& phi, Matrix3& R, Matrix3& left_jacobian) {
  const internal::Coefficients k = internal::CoefficientsAt(phi.squaredNorm());
  R = internal::Polynomial(phi, k.a, k.b);
  left_jacobian = internal::Polynomial(phi, k.b, k.c);
}

/// Inverse right Jacobian: Log(Exp(phi) Exp(d)) = phi + JrInverse(phi) d to first order in d.
template <int = 0>
Matrix3 JrInverse(const Vector3& phi) {
  return internal::Polynomial(phi, 0.5, internal::InverseJacobianCoefficient(phi.squaredNorm()));
}

/// Inverse left Jacobian: Log(Exp(d) Exp(phi)) = phi + JlInverse(phi) d to first order in d.
template <int = 0>
Matrix3 JlInverse(const Vector3& phi) {
  return internal::Polynomial(phi, -0.5, internal::InverseJacobianCoefficient(phi.squaredNorm()));
}

}  // namespace glissade::so3
