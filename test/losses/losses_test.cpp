// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "glissade/losses/loss.h"
#include "glissade/losses/trivial.h"
#include "glissade/losses/tukey.h"
#include "glissade/testing/numeric_derivative.h"

namespace glissade {
namespace {

/// rho' and rho'' are the derivatives of rho, which starts like s and never bends up.
template <class L>
void CheckDerivatives(const L& loss) {
  double rho[3];
  loss.Evaluate(0.0, rho);
  EXPECT_EQ(rho[0], 0.0);
  EXPECT_EQ(rho[1], 1.0);
  for (const double s : {1e-3, 0.1, 0.7, 1.9, 2.2, 5.0, 20.0, 1e3, 1e6}) {
    loss.Evaluate(s, rho);
    EXPECT_GE(rho[1], 0.0);
    EXPECT_LE(rho[1], 1.0);
    EXPECT_LE(rho[0], s * (1 + 1e-15));
    EXPECT_LE(rho[2], 0.0);
    const NumericDerivative d = Differentiate(
        [&](double t, double* y) {
          double at[3];
          loss.Evaluate(s + t, at);
          y[0] = at[0];
          y[1] = at[1];
          return true;
        },
        2, 1e-2 * s);
    EXPECT_NEAR(d.value[0], rho[1], 1e-9) << s;
    EXPECT_NEAR(d.value[1], rho[2], 1e-9 * (1.0 + std::abs(rho[2]) / s)) << s;
  }
}

TEST(Losses, DerivativesAgree) {
  CheckDerivatives(Trivial{});
  for (const double width : {0.3, 1.0, 2.5}) {
    CheckDerivatives(Huber{width});
    CheckDerivatives(Cauchy{width});
    CheckDerivatives(Tukey{width});
  }
}

TEST(Losses, KnownValues) {
  double rho[3];
  Huber{2.0}.Evaluate(9.0, rho);  // 2 * 2 * 3 - 4
  EXPECT_DOUBLE_EQ(rho[0], 8.0);
  EXPECT_DOUBLE_EQ(rho[1], 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(rho[2], -1.0 / 27.0);
  Cauchy{2.0}.Evaluate(4.0, rho);
  EXPECT_DOUBLE_EQ(rho[0], 4.0 * std::log(2.0));
  EXPECT_DOUBLE_EQ(rho[1], 0.5);
  EXPECT_DOUBLE_EQ(rho[2], -1.0 / 16.0);
  Tukey{3.0}.Evaluate(4.5, rho);
  EXPECT_DOUBLE_EQ(rho[0], 3.0 * (1.0 - 0.125));
  EXPECT_DOUBLE_EQ(rho[1], 0.25);
  EXPECT_DOUBLE_EQ(rho[2], -1.0 / 9.0);
  Tukey{3.0}.Evaluate(100.0, rho);
  EXPECT_DOUBLE_EQ(rho[0], 3.0);
  EXPECT_EQ(rho[1], 0.0);
}

TEST(Losses, ContinuousAtTheWidth) {
  const double width = 1.345, s = width * width;
  double below[3], above[3];
  Huber{width}.Evaluate(s, below);
  Huber{width}.Evaluate(std::nextafter(s, 9.0), above);
  EXPECT_NEAR(below[0], above[0], 1e-14);
  EXPECT_NEAR(below[1], above[1], 1e-14);
  Tukey{width}.Evaluate(s, below);
  Tukey{width}.Evaluate(std::nextafter(s, 9.0), above);
  EXPECT_NEAR(below[0], above[0], 1e-14);
  EXPECT_NEAR(below[1], above[1], 1e-14);
}

TEST(Losses, WidthMustBePositiveAndFinite) {
  for (const double bad : {0.0, -1.0}) {
    EXPECT_EQ(Loss(Huber{bad}).Validate().code(), StatusCode::kNotPositive);
    EXPECT_EQ(Loss(Cauchy{bad}).Validate().code(), StatusCode::kNotPositive);
    EXPECT_EQ(Loss(Tukey{bad}).Validate().code(), StatusCode::kNotPositive);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Loss(Huber{nan}).Validate().code(), StatusCode::kNotFinite);
  EXPECT_TRUE(Loss(Huber{1.0}).Validate().ok());
  EXPECT_TRUE(Loss(Trivial{}).Validate().ok());
}

struct GemanMcClure {  // a user's own: no Validate
  double width;
  void Evaluate(double s, double rho[3]) const {
    const double w = width * width / (width * width + s);
    rho[0] = w * s;
    rho[1] = w * w;
    rho[2] = -2.0 * w * w * w / (width * width);
  }
};

TEST(Loss, HoldsAnyLossByValue) {
  EXPECT_TRUE(Loss().trivial());
  const Loss loss = Huber{2.0};
  EXPECT_FALSE(loss.trivial());
  ASSERT_NE(loss.As<Huber>(), nullptr);
  EXPECT_EQ(loss.As<Huber>()->width, 2.0);
  EXPECT_EQ(loss.As<Cauchy>(), nullptr);
  EXPECT_EQ(loss, Loss(Huber{2.0}));
  EXPECT_FALSE(loss == Loss(Huber{3.0}));
  EXPECT_FALSE(loss == Loss(Tukey{2.0}));
  double a[3], b[3];
  loss.Evaluate(9.0, a);
  Huber{2.0}.Evaluate(9.0, b);
  EXPECT_EQ(a[0], b[0]);

  CheckDerivatives(GemanMcClure{1.5});
  EXPECT_TRUE(Loss(GemanMcClure{1.5}).Validate().ok());
}

}  // namespace
}  // namespace glissade
