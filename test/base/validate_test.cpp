// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/validate.h"

#include <gtest/gtest.h>

#include <limits>

namespace glissade {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(Validate, FiniteNamesTheIndex) {
  const double good[3] = {1.0, -1e308, 0.0};
  EXPECT_TRUE(ValidateFinite(good, 3, "point").ok());
  for (const double bad : {kNan, kInf, -kInf}) {
    const double x[3] = {1.0, bad, 2.0};
    const Status status = ValidateFinite(x, 3, "point");
    EXPECT_EQ(status.code(), StatusCode::kNotFinite);
    EXPECT_EQ(status.message().substr(0, 18), "point: value[1] is");
  }
}

TEST(Validate, Positive) {
  EXPECT_TRUE(ValidatePositive(1e-300, "width").ok());
  EXPECT_EQ(ValidatePositive(0.0, "width").code(), StatusCode::kNotPositive);
  EXPECT_EQ(ValidatePositive(-2.0, "width").message(), "width: value is -2, not positive");
  EXPECT_EQ(ValidatePositive(kNan, "width").code(), StatusCode::kNotFinite);
  EXPECT_EQ(ValidatePositive(kInf, "width").code(), StatusCode::kNotFinite);
}

TEST(Validate, PoseNeedsAUnitQuaternion) {
  double pose[7] = {1.0, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8};
  EXPECT_TRUE(ValidatePose(pose, "pose").ok());
  pose[6] = 0.8 + 1e-7;
  EXPECT_TRUE(ValidatePose(pose, "pose").ok());
  pose[6] = 0.8 + 1e-5;
  EXPECT_EQ(ValidatePose(pose, "pose").code(), StatusCode::kInvalidArgument);
  const double zero[7] = {};
  EXPECT_EQ(ValidatePose(zero, "pose").message(), "pose: quaternion has norm 0, not 1");
  pose[0] = kNan;
  EXPECT_EQ(ValidatePose(pose, "pose").code(), StatusCode::kNotFinite);
  const double huge[7] = {0.0, 0.0, 0.0, 1e200, 1e200, 0.0, 0.0};  // the norm overflows
  EXPECT_FALSE(ValidatePose(huge, "pose").ok());
}

}  // namespace
}  // namespace glissade
