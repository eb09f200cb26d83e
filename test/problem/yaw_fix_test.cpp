// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/tilt_scene.h"

// Partial fixing of an anchor that starts 6 degrees off in tilt.

namespace glissade::test {
namespace {

constexpr double kTiltError = 6.0 * std::numbers::pi / 180.0;

SolveOptions ToConvergence() {
  SolveOptions options;
  options.max_iterations = 200;
  options.cost_tolerance = 1e-14;
  return options;
}

/// Angle between the body's up direction and the true one.
double TiltChange(const Pose& a, const Pose& b) {
  return so3::Log(Quaternion(a.q() * b.q().conjugate())).head<2>().norm();
}

TEST(YawFix, YawAndPositionStayWhileTiltIsCorrected) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    TiltScene<ChartAnchor> scene(seed, kTiltError);
    ASSERT_TRUE(scene.status.ok()) << scene.status.message();
    const SolveSummary summary = scene.problem.Solve(ToConvergence());
    ASSERT_TRUE(summary.converged()) << summary.BriefReport();
    EXPECT_LT(std::abs(YawSince(scene.start, scene.Now())), 1e-12);
    EXPECT_EQ(scene.Now().p(), scene.start.p());
    // It did have something to do.
    EXPECT_NEAR(TiltChange(scene.Now(), scene.start), kTiltError, 0.02);
  }
}

// The chart's R0 is the rotation of SetFixed, not of the last solve: many short solves, with
// measurements that pull elsewhere in between, hold the same yaw as one long solve.
TEST(YawFix, R0StaysThroughManySolves) {
  TiltScene<ChartAnchor> scene(1, kTiltError);
  GraphRandom random(77);
  for (int turn = 0; turn < 50; ++turn) {
    const Vector3 pull = Vector3::UnitZ() + random.NormalVector<3>(0.2);
    EdgeOptions<EdgeTilt> options;
    options.sqrt_information = 2000.0 * Matrix3::Identity();
    const auto edge = scene.problem.AddEdge(EdgeTilt{pull.normalized()}, {scene.anchor}, options);
    ASSERT_TRUE(edge.ok());
    SolveOptions one_step;
    one_step.max_iterations = 2;
    ASSERT_TRUE(scene.problem.Solve(one_step).ok());
    EXPECT_LT(std::abs(YawSince(scene.start, scene.Now())), 1e-12) << "turn " << turn;
    EXPECT_EQ(scene.Now().p(), scene.start.p());
    ASSERT_TRUE(scene.problem.RemoveEdge(edge.value()).ok());
  }
}

TEST(YawFix, RejectedAndRolledBackStepsLeaveTheChartAlone) {
  TiltScene<ChartAnchor> scene(2, kTiltError);
  const Snapshot before = scene.problem.GetSnapshot();
  ASSERT_TRUE(scene.problem.MakeHessian().ok());
  ASSERT_TRUE(scene.problem.SolveLinearSystem(1e-4).ok());
  ASSERT_TRUE(scene.problem.UpdateStates().ok());
  EXPECT_NE(scene.problem.GetSnapshot().states, before.states);
  ASSERT_TRUE(scene.problem.RollbackStates().ok());
  EXPECT_EQ(scene.problem.GetSnapshot().states, before.states);
  for (std::size_t k = 0; k < before.free_tangents.size(); ++k) {
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(scene.problem.free_tangents()[k].dphi[i], before.free_tangents[k].dphi[i]);
  }
}

// Set() anchors the chart at the new value; what is held from then on is the new yaw.
TEST(YawFix, SetMovesTheAnchor) {
  TiltScene<ChartAnchor> scene(3, kTiltError);
  ASSERT_TRUE(scene.problem.Solve(ToConvergence()).converged());
  Pose turned = scene.Now();
  turned.q() = so3::ExpQuaternion(Vector3(0.02, -0.03, 0.3)) * turned.q();
  ASSERT_TRUE(scene.problem.Set(scene.anchor, VertexPose{turned}).ok());
  ASSERT_TRUE(scene.problem.Solve(ToConvergence()).converged());
  EXPECT_LT(std::abs(YawSince(turned, scene.Now())), 1e-12);
}

TEST(YawFix, PositionAloneLeavesRotationFree) {
  TiltScene<ChartAnchor> scene(4, kTiltError);
  ASSERT_TRUE(scene.problem.SetFixed(scene.anchor, Fix::kPosition).ok());
  // Something that knows the heading: 0.2 rad from the anchor's.
  Pose heading = scene.problem.Get(scene.poses[0]).pose;
  heading.q() = so3::ExpQuaternion(Vector3(0.0, 0.0, 0.2)) * heading.q();
  EdgeOptions<EdgeRelativePose> options;
  ASSERT_TRUE(scene.problem.Solve(ToConvergence()).converged());
  const double yaw_before = YawSince(scene.start, scene.Now());
  const VertexHandle<VertexPose> north = scene.problem.AddVertex(VertexPose{heading});
  ASSERT_TRUE(scene.problem.SetFixed(north).ok());
  options.sqrt_information = 100.0 * Matrix6::Identity();
  options.sqrt_information->topRows<3>().setZero();
  ASSERT_TRUE(
      scene.problem.AddEdge(EdgeRelativePose{Pose()}, {north, scene.poses[0]}, options).ok());
  ASSERT_TRUE(scene.problem.Solve(ToConvergence()).converged());
  EXPECT_EQ(scene.Now().p(), scene.start.p());
  EXPECT_GT(std::abs(YawSince(scene.start, scene.Now()) - yaw_before), 0.1);
}

}  // namespace
}  // namespace glissade::test
