// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/edges/body_velocity.h"

#include <gtest/gtest.h>

#include "edges/edge_test_util.h"

namespace glissade {
namespace {

using test::Random;

TEST(BodyVelocity, Jacobians) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector3 v = random.Vec3(2.0), ba = random.Vec3(0.3);
    test::ExpectJacobians(EdgeBodyVelocity{random.Vec3(1.0)},
                          VertexPose{Pose(random.Rotation(3.0), random.Vec3(2.0))},
                          VertexSpeedBias(v, ba, random.Vec3(0.1)));
  }
}

TEST(BodyVelocity, IsBlindToTheHeading) {
  Random random(2);
  const Pose pose(random.Rotation(3.0), random.Vec3(2.0));
  const Vector3 v = random.Vec3(2.0);
  const Pose turn(so3::ExpQuaternion(Vector3(0.0, 0.0, 1.2)), random.Vec3(5.0));
  Vector3 before, after;
  const EdgeBodyVelocity edge{random.Vec3(1.0)};
  ASSERT_TRUE(edge.Evaluate(VertexPose{pose}, VertexSpeedBias(v, {0, 0, 0}, {0, 0, 0}), before,
                            nullptr, nullptr));
  ASSERT_TRUE(edge.Evaluate(VertexPose{turn * pose},
                            VertexSpeedBias(turn.R() * v, {0, 0, 0}, {0, 0, 0}), after, nullptr,
                            nullptr));
  EXPECT_LT((before - after).norm(), 1e-14);
}

}  // namespace
}  // namespace glissade
