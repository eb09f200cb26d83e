// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "common/random_states.h"
#include "glissade/testing.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/vertices/vector.h"

namespace glissade {
namespace {

using test::Random;

static_assert(kIsEliminated<VertexInverseDepth> && kIsEliminated<VertexPointXYZ>);
static_assert(!kIsEliminated<VertexPose> && !kIsEliminated<VertexVector<1>>);

/// Axioms at random states of a type whose state is any list of numbers, and refusal of NaN.
template <class V>
void CheckNumbers() {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    V x;
    for (int i = 0; i < V::kAmbientDim; ++i)
      x.Data()[i] = random.Uniform(-10.0, 10.0);
    const VertexCheck check = CheckVertexAxioms(x);
    EXPECT_TRUE(check.ok) << check.message;
    EXPECT_TRUE(x.Validate().ok());
    x.Data()[V::kAmbientDim - 1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(x.Validate().code(), StatusCode::kNotFinite);
  }
}

TEST(Vertices, Axioms) {
  CheckNumbers<VertexInverseDepth>();
  CheckNumbers<VertexPointXYZ>();
  CheckNumbers<VertexSpeedBias>();
  CheckNumbers<VertexCameraBal>();
  CheckNumbers<VertexVector<1>>();
  CheckNumbers<VertexVector<5>>();
}

TEST(VertexPose, Axioms) {
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const VertexCheck check = CheckVertexAxioms(VertexPose{random.RandomPose(10.0)});
    EXPECT_TRUE(check.ok) << check.message;
  }
  for (const double angle : test::kSpecialAngles) {
    const VertexPose x{random.RandomPose(10.0, angle)};
    // Steps of up to just below pi: |d| <= sqrt(3) * 1.8.
    const VertexCheck check = CheckVertexAxioms(x, {.max_delta = 1.8});
    EXPECT_TRUE(check.ok) << check.message;
  }
}

TEST(VertexPose, TangentIsWorldPositionAndBodyRotation) {
  Random random(3);
  const Pose T_w_b = random.RandomPose(2.0);
  VertexPose x{T_w_b};
  const Vector3 dp(0.1, 0.2, -0.3), dtheta(0.4, -0.5, 0.6);
  Vector6 delta;
  delta << dp, dtheta;
  x.Plus(delta.data());
  EXPECT_LT((x.pose.p() - (T_w_b.p() + dp)).norm(), 1e-15);
  EXPECT_LT((x.pose.R() - T_w_b.R() * so3::Exp(dtheta)).norm(), 1e-15);
}

TEST(VertexPose, StaysUnitOverManySteps) {
  Random random(4);
  VertexPose x{random.RandomPose(2.0)};
  for (int step = 0; step < 10000; ++step) {
    double delta[6];
    for (double& d : delta)
      d = random.Uniform(-1.0, 1.0);
    x.Plus(delta);
  }
  EXPECT_NEAR(x.pose.q().norm(), 1.0, 1e-15);
}

TEST(VertexPose, ValidateNeedsAUnitQuaternion) {
  VertexPose x;
  EXPECT_TRUE(x.Validate().ok());
  x.pose.data[3] = 0.1;
  EXPECT_EQ(x.Validate().code(), StatusCode::kInvalidArgument);
  EXPECT_NE(x.Validate().message().find("quaternion"), std::string::npos);
  x.pose.data[0] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(x.Validate().code(), StatusCode::kNotFinite);
}

TEST(VertexSpeedBias, OrderIsVelocityAccelerometerGyroscope) {
  const VertexSpeedBias x(Vector3(1, 2, 3), Vector3(4, 5, 6), Vector3(7, 8, 9));
  for (int i = 0; i < 9; ++i)
    EXPECT_EQ(x.Data()[i], i + 1);
  EXPECT_EQ(x.v()[0], 1.0);
  EXPECT_EQ(x.ba()[0], 4.0);
  EXPECT_EQ(x.bg()[0], 7.0);
}

// The checker must catch what it is there for: variants with one fault each.
struct LeftPlus : VertexPose {  // turns on the wrong side, while Minus does not
  void Plus(const double* d) {
    pose.p() += Vector3(d[0], d[1], d[2]);
    pose.q() = so3::ExpQuaternion(Vector3(d[3], d[4], d[5])) * Quaternion(pose.q());
  }
  void Minus(const LeftPlus& x0, double* d) const { VertexPose::Minus(x0, d); }
};
struct ForgetsAnEntry : VertexVector<3> {
  void Minus(const ForgetsAnEntry& x0, double* d) const {
    for (int i = 0; i < 2; ++i)
      d[i] = value[static_cast<std::size_t>(i)] - x0.Data()[i];
  }
};
struct SmallStepsVanish : VertexVector<1> {  // an "optimization" of the kind that stalls a solver
  void Plus(const double* d) { value[0] += std::abs(d[0]) < 1e-3 ? 0.0 : d[0]; }
  void Minus(const SmallStepsVanish& x0, double* d) const { d[0] = value[0] - x0.value[0]; }
};
struct LeavesTheManifold : VertexPose {
  void Plus(const double* d) {
    VertexPose::Plus(d);
    for (int i = 3; i < 7; ++i)
      pose.data[i] *= 1.0 + d[0] * d[0];
  }
  void Minus(const LeavesTheManifold& x0, double* d) const { VertexPose::Minus(x0, d); }
};

struct SaysItIsASum {  // of a scale: as many numbers as degrees of freedom, but no sum
  static constexpr int kAmbientDim = 1;
  static constexpr int kTangentDim = 1;
  static constexpr bool kAdditive = true;
  double s = 2.0;
  double* Data() { return &s; }
  const double* Data() const { return &s; }
  void Plus(const double* d) { s *= std::exp(d[0]); }
  void Minus(const SaysItIsASum& x0, double* d) const { d[0] = std::log(s / x0.s); }
};
struct WrongMinusJacobian : VertexPose {
  void Minus(const WrongMinusJacobian& x0, double* d) const { VertexPose::Minus(x0, d); }
  void MinusJacobian(const WrongMinusJacobian&, double* D) const {
    for (int k = 0; k < 36; ++k)
      D[k] = k % 7 == 0 ? 1.0 : 0.0;
  }
};

// What a type inherits is for what it inherits: with a Minus() of its own, differences are right.
TEST(VertexOps, AnInheritedMinusJacobianDoesNotCount) {
  EXPECT_NE(kVertexOps<VertexPose>.minus_jacobian, nullptr);
  EXPECT_NE(kVertexOps<WrongMinusJacobian>.minus_jacobian, nullptr);
  EXPECT_EQ(kVertexOps<LeftPlus>.minus_jacobian, nullptr);
}

// Of the library's types one was forgotten, and was differentiated by differences.
TEST(VertexOps, TheAdditiveOnesAreAdditive) {
  EXPECT_TRUE(kVertexOps<VertexVector<2>>.additive);
  EXPECT_TRUE(kVertexOps<VertexVector<40>>.additive);
  EXPECT_TRUE(kVertexOps<VertexSpeedBias>.additive);
  EXPECT_TRUE(kVertexOps<VertexInverseDepth>.additive);
  EXPECT_TRUE(kVertexOps<VertexPointXYZ>.additive);
  EXPECT_TRUE(kVertexOps<VertexCameraBal>.additive);
  EXPECT_FALSE(kVertexOps<VertexPose>.additive);
}

TEST(CheckVertexAxioms, FindsFaults) {
  Random random(5);
  LeftPlus left;
  left.pose = random.RandomPose(1.0);
  EXPECT_NE(CheckVertexAxioms(left).message.find("(x boxplus d) boxminus x"), std::string::npos);
  EXPECT_FALSE(CheckVertexAxioms(ForgetsAnEntry{}).ok);
  EXPECT_FALSE(CheckVertexAxioms(SmallStepsVanish{}).ok);
  EXPECT_NE(CheckVertexAxioms(SaysItIsASum{}).message.find("kAdditive"), std::string::npos);
  EXPECT_NE(CheckVertexAxioms(WrongMinusJacobian{}).message.find("MinusJacobian"),
            std::string::npos);
  LeavesTheManifold leaves;
  EXPECT_NE(CheckVertexAxioms(leaves).message.find("Validate"), std::string::npos);
}

}  // namespace
}  // namespace glissade
