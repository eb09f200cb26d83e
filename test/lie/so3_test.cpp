// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/lie/so3.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <numbers>
#include <vector>

#include "common/random_states.h"

namespace glissade {
namespace {

using test::Random;
using Matrix3l = Eigen::Matrix<long double, 3, 3>;
constexpr double kPi = std::numbers::pi;
constexpr double kEps = std::numeric_limits<double>::epsilon();

/// From 0 through the series, their border and the closed forms to pi and beyond.
std::vector<double> Angles() {
  std::vector<double> angles = {0.0, 1e-300, 1e-160, 1e-20};
  for (int e = -12; e <= -3; ++e)
    angles.push_back(std::pow(10.0, e));
  for (const double a :
       {0.01, 0.1, 0.3, 0.4999999, 0.5, 0.5000001, 0.9999, 1.0, 1.0001, 2.0, 3.0}) {
    angles.push_back(a);
  }
  for (const double d : {1e-1, 1e-3, 1e-5, 1e-8, 1e-12, 0.0})
    angles.push_back(kPi - d);
  for (const double a : {kPi + 1e-8, 4.0, 5.5})
    angles.push_back(a);
  return angles;
}

Matrix3l HatLong(const Vector3& v) {
  const Eigen::Matrix<long double, 3, 1> w = v.cast<long double>();
  Matrix3l m;
  m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return m;
}

/// sum_k A^k / (k + shift)!, the defining series of exp (shift 0) and of the left Jacobian (1).
Matrix3l Series(const Matrix3l& A, int shift) {
  Matrix3l term = Matrix3l::Identity(), sum = term;
  for (int k = 1; k < 80; ++k) {
    term = term * A / static_cast<long double>(k + shift);
    sum += term;
  }
  return sum;
}

double Error(const Matrix3& a, const Matrix3l& reference) {
  return static_cast<double>((a.cast<long double>() - reference).cwiseAbs().maxCoeff() /
                             reference.cwiseAbs().maxCoeff());
}

TEST(So3, HatIsTheCrossProduct) {
  const Vector3 a(1.0, -2.0, 3.0), b(0.5, 7.0, -4.0);
  EXPECT_EQ(so3::Hat(a) * b, a.cross(b));
}

TEST(So3, ExpAndJacobiansEqualTheirSeries) {
  Random random(1);
  for (const double angle : Angles()) {
    SCOPED_TRACE(angle);
    for (int trial = 0; trial < 10; ++trial) {
      const Vector3 phi = angle * random.Direction();
      const Matrix3l A = HatLong(phi);
      const Matrix3l Jl = Series(A, 1);
      EXPECT_LT(Error(so3::Exp(phi), Series(A, 0)), 8 * kEps);
      EXPECT_LT(Error(RotationMatrix(so3::ExpQuaternion(phi).coeffs().data()), Series(A, 0)),
                8 * kEps);
      EXPECT_LT(Error(so3::Jl(phi), Jl), 8 * kEps);
      Matrix3 R, left;
      so3::ExpAndJl(phi, R, left);
      EXPECT_EQ(R, so3::Exp(phi));
      EXPECT_EQ(left, so3::Jl(phi));
      EXPECT_LT(Error(so3::Jr(phi), Jl.transpose()), 8 * kEps);
      if (angle > 4.5) continue;  // towards 2 pi Jl becomes singular
      EXPECT_LT(Error(so3::JlInverse(phi), Jl.inverse()), 16 * kEps);
      EXPECT_LT(Error(so3::JrInverse(phi), Jl.inverse().transpose()), 16 * kEps);
    }
  }
}

TEST(So3, SmallCoefficientsKeepTheirRelativeAccuracy) {
  // The deviation from the identity, not only the whole matrix, is right to many digits: the terms
  // of second and third order would vanish in a comparison of matrices.
  for (const double t : {1e-8, 1e-5, 1e-3, 0.03, 0.3, 0.4999, 0.5001, 0.7, 3.0}) {
    SCOPED_TRACE(t);
    const double x = t * t;
    const long double tl = std::sqrt(static_cast<long double>(x));
    long double sine = 1, one_minus_cos = 0.5L, t_minus_sin = 1.0L / 6, s = 1, c = 0.5L, d = s / 6;
    for (int k = 1; k < 30; ++k) {
      s *= -tl * tl / ((2 * k) * (2 * k + 1));
      c *= -tl * tl / ((2 * k + 1) * (2 * k + 2));
      d *= -tl * tl / ((2 * k + 2) * (2 * k + 3));
      sine += s;
      one_minus_cos += c;
      t_minus_sin += d;
    }
    const auto relative = [](double a, long double b) {
      return static_cast<double>(std::abs(a / b - 1.0L));
    };
    const so3::internal::Coefficients k = so3::internal::CoefficientsAt(x);
    EXPECT_LT(relative(k.a, sine), 12 * kEps);  // at 3, where the sine is small
    EXPECT_LT(relative(k.b, one_minus_cos), 4 * kEps);
    EXPECT_LT(relative(k.c, t_minus_sin), 60 * kEps);
    // 1 - (t/2) cot(t/2) = (sin - (t/2) cos) / sin of the half angle; by series, as cancellation
    // would spoil even long double: sin h - h cos h = sum (-1)^k+1 2k h^(2k+1) / (2k+1)!.
    const long double h = tl / 2;
    long double numerator = 0, power = h, sin_h = h, factorial_term = h;
    for (int k = 1; k < 30; ++k) {
      power *= h * h / ((2 * k) * (2 * k + 1));
      numerator += (k % 2 == 1 ? 1 : -1) * 2 * k * power;
      factorial_term *= -h * h / ((2 * k) * (2 * k + 1));
      sin_h += factorial_term;
    }
    const long double inverse = numerator / sin_h / (tl * tl);
    EXPECT_LT(relative(so3::internal::InverseJacobianCoefficient(x), inverse), 60 * kEps);
  }
}

TEST(So3, LogInvertsExp) {
  Random random(2);
  for (const double angle : Angles()) {
    if (angle > kPi) continue;
    SCOPED_TRACE(angle);
    for (int trial = 0; trial < 10; ++trial) {
      const Vector3 phi = angle * random.Direction();
      const Quaternion q = so3::ExpQuaternion(phi);
      const Quaternion minus_q(-q.w(), -q.x(), -q.y(), -q.z());
      const auto error = [&](const Vector3& log) {
        // At pi itself both signs are right.
        const double e = (log - phi).cwiseAbs().maxCoeff();
        return angle < kPi - 1e-14 ? e : std::min(e, (log + phi).cwiseAbs().maxCoeff());
      };
      EXPECT_LE(error(so3::Log(q)), 8 * kEps * angle);
      EXPECT_LE(error(so3::Log(minus_q)), 8 * kEps * angle);
      EXPECT_LE(error(so3::Log(so3::Exp(phi))), 16 * kEps * std::max(angle, 1e-12));
      EXPECT_LE(so3::Log(q).norm(), kPi * (1 + kEps));
    }
  }
}

TEST(So3, LogIgnoresTheNormOfTheQuaternion) {
  const Vector3 phi(0.3, -1.2, 0.7);
  Quaternion q = so3::ExpQuaternion(phi);
  q.coeffs() *= 1.7;
  EXPECT_LT((so3::Log(q) - phi).norm(), 1e-15);
  EXPECT_EQ(so3::Log(Quaternion(0, 0, 0, 0)), Vector3(0, 0, 0));
}

TEST(So3, NanStaysNan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(so3::Exp(Vector3(nan, 0, 0)).hasNaN());
  EXPECT_TRUE(so3::Log(Quaternion(nan, 0, 0, 1)).hasNaN());
  EXPECT_TRUE(so3::Log(Quaternion(1, nan, 0, 0)).hasNaN());
}

/// The definitions: on which side each Jacobian stands.
TEST(So3, JacobiansAreDerivatives) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3 phi = random.Uniform(0.0, 3.1) * random.Direction();
    const Vector3 d = 1e-5 * random.Direction();
    const auto log = [](const Matrix3& R) { return so3::Log(R); };
    const Matrix3 R = so3::Exp(phi), plus = so3::Exp(phi + d), minus = so3::Exp(phi - d);
    const Vector3 right = 0.5 * (log(R.transpose() * plus) - log(R.transpose() * minus));
    const Vector3 left = 0.5 * (log(plus * R.transpose()) - log(minus * R.transpose()));
    EXPECT_LT((right - so3::Jr(phi) * d).norm(), 1e-9 * d.norm());
    EXPECT_LT((left - so3::Jl(phi) * d).norm(), 1e-9 * d.norm());
    const Vector3 log_right = 0.5 * (log(R * so3::Exp(d)) - log(R * so3::Exp(-d)));
    const Vector3 log_left = 0.5 * (log(so3::Exp(d) * R) - log(so3::Exp(-d) * R));
    EXPECT_LT((log_right - so3::JrInverse(phi) * d).norm(), 1e-9 * d.norm());
    EXPECT_LT((log_left - so3::JlInverse(phi) * d).norm(), 1e-9 * d.norm());
  }
}

}  // namespace
}  // namespace glissade
