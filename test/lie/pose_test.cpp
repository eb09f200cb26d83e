// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/lie/pose.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "common/random_states.h"
#include "glissade/lie/quaternion_error.h"

namespace glissade {
namespace {

using test::Random;

TEST(Pose, LayoutIsPositionThenXyzw) {
  const Quaternion q(0.5, -0.5, 0.5, 0.5);  // Eigen's constructor: w first
  const Pose pose(q, Vector3(1.0, 2.0, 3.0));
  const double expected[7] = {1.0, 2.0, 3.0, -0.5, 0.5, 0.5, 0.5};
  for (int i = 0; i < 7; ++i)
    EXPECT_EQ(pose.data[i], expected[i]);
  EXPECT_EQ(pose.q().w(), 0.5);
  EXPECT_EQ(Pose().R(), Matrix3::Identity());
}

TEST(Pose, TakesEigensOwnTypes) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Eigen::Vector3d p(1.0, 2.0, 3.0);
  const Pose a(R, p), b(Eigen::Quaterniond(R), p);
  EXPECT_LT((a.R() - R).norm(), 1e-15);
  EXPECT_LT((b.R() - R).norm(), 1e-15);
  EXPECT_EQ(a.p(), p);
}

TEST(Pose, ComposesAndInverts) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose T_a_b = random.RandomPose(3.0), T_b_c = random.RandomPose(3.0);
    const Vector3 x_c = random.Vec3(5.0);
    EXPECT_LT(((T_a_b * T_b_c) * x_c - T_a_b * (T_b_c * x_c)).norm(), 1e-14);
    EXPECT_LT((T_a_b.Inverse() * (T_a_b * x_c) - x_c).norm(), 1e-14);
    EXPECT_LT((T_a_b * x_c - (T_a_b.q().toRotationMatrix() * x_c + T_a_b.p())).norm(), 1e-14);
  }
}

TEST(Pose, FromMatrixKeepsItsDigitsNearPi) {
  Random random(2);
  for (const double angle : test::kSpecialAngles) {
    const Vector3 phi = angle * random.Direction();
    const Pose pose(so3::Exp(phi), Vector3::Zero());
    EXPECT_LT((so3::Log(Quaternion(pose.q())) - phi).norm(), 1e-15) << angle;
  }
}

TEST(Pose, NormalizeLeavesWhatHasNoDirection) {
  Pose pose(Quaternion(2.0, 0.0, 0.0, 0.0), Vector3::Zero());
  pose.Normalize();
  EXPECT_EQ(pose.data[6], 1.0);
  Pose zero(Quaternion(0.0, 0.0, 0.0, 0.0), Vector3::Zero());
  const Pose before = zero;
  zero.Normalize();
  EXPECT_EQ(zero, before);
}

TEST(QuaternionError, JacobiansAreDerivatives) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Quaternion e = random.Rotation();
    const Vector3 d = 1e-5 * random.Direction();
    const Quaternion plus = so3::ExpQuaternion(d), minus = so3::ExpQuaternion(-d);
    const Vector3 right = (e * plus).vec() - (e * minus).vec();
    const Vector3 left = (plus * e).vec() - (minus * e).vec();
    EXPECT_LT((right - TwoVecRightJacobian(e) * d).norm(), 1e-9 * d.norm());
    EXPECT_LT((left - TwoVecLeftJacobian(e) * d).norm(), 1e-9 * d.norm());
  }
  EXPECT_EQ(WithPositiveW(Quaternion(-0.6, 0.8, 0.0, 0.0)).x(), -0.8);
}

}  // namespace
}  // namespace glissade
