// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/initial_state_prior.h"

#include <gtest/gtest.h>

#include "common/random_states.h"
#include "edges/edge_test_util.h"

namespace glissade {
namespace {

using test::Random;

VertexSpeedBias RandomState(Random& random) {
  const Vector3 v = random.Vec3(2.0), ba = random.Vec3(0.3);
  return {v, ba, random.Vec3(0.1)};
}

TEST(InitialStatePrior, Jacobians) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const EdgeInitialState edge{Pose(random.Rotation(3.0), random.Vec3(2.0)), RandomState(random)};
    test::ExpectJacobians(edge, VertexPose{Pose(random.Rotation(3.0), random.Vec3(2.0))},
                          RandomState(random));
  }
}

TEST(InitialStatePrior, IsZeroAtItsStateAndBlindToHeadingAndPlace) {
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const EdgeInitialState edge{Pose(random.Rotation(3.0), random.Vec3(2.0)), RandomState(random)};
    const VertexPose pose{Pose(random.Rotation(3.0), random.Vec3(2.0))};
    const VertexSpeedBias state = RandomState(random);
    Vector<11> at_itself, before, after;
    ASSERT_TRUE(
        edge.Evaluate(VertexPose{edge.T_w_b}, edge.speed_bias, at_itself, nullptr, nullptr));
    EXPECT_LT(at_itself.norm(), 1e-13);
    const Pose turn(so3::ExpQuaternion(Vector3(0.0, 0.0, random.Uniform(-3.0, 3.0))),
                    random.Vec3(5.0));
    VertexSpeedBias turned = state;
    turned.v() = turn.R() * state.v();
    ASSERT_TRUE(edge.Evaluate(pose, state, before, nullptr, nullptr));
    ASSERT_TRUE(edge.Evaluate(VertexPose{turn * pose.pose}, turned, after, nullptr, nullptr));
    EXPECT_LT((before - after).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace glissade
