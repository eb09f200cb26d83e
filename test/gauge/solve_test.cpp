// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "glissade/gauge/constraint.h"
#include "glissade/minimizer/minimizer.h"
#include "glissade/structure/structure.h"
#include "support/gauge_scene.h"
#include "support/graph_random.h"

// Gauges as an option of a solve.

namespace glissade::test {
namespace {

GaugeSceneOptions Vision(bool inverse_depth = true) {
  GaugeSceneOptions options;
  options.imu = false;
  options.inverse_depth = inverse_depth;
  return options;
}

double CostIn(GaugeScene* scene, const Gauge& gauge) {
  const SolveSummary& summary = scene->problem.Solve(Converge(gauge));
  EXPECT_TRUE(summary.converged()) << summary.BriefReport() << summary.status.message();
  return scene->problem.Cost().value();
}

TEST(GaugeSolve, AllGaugesEndAtTheSameCost) {
  for (const bool inverse_depth : {true, false}) {
    GaugeSceneOptions options;
    options.inverse_depth = inverse_depth;
    GaugeScene free(1, options), fixed(1, options), prior(1, options);
    const double cost = CostIn(&free, Gauge::Free);
    EXPECT_NEAR(CostIn(&fixed, Gauge::Fixed{fixed.poses[0]}), cost, 1e-9 * cost);
    EXPECT_NEAR(CostIn(&prior, Gauge::Prior{prior.poses[0], 1e5}), cost, 1e-9 * cost);
  }
}

TEST(GaugeSolve, FixedHoldsPositionAndYawOfAnyAnchor) {
  for (const std::size_t anchor : {0u, 4u, 9u}) {
    GaugeScene scene(2);
    const Pose before = scene.problem.Get(scene.poses[anchor]).pose;
    CostIn(&scene, Gauge::Fixed{scene.poses[anchor]});
    const Pose after = scene.problem.Get(scene.poses[anchor]).pose;
    EXPECT_EQ(before.p(), after.p());
    EXPECT_LT(std::abs(YawBetween(before, after)), 1e-13);
    EXPECT_GT(so3::Log(Quaternion(after.q() * before.q().conjugate())).norm(), 1e-3)
        << "roll and pitch are free";
  }
}

TEST(GaugeSolve, TheGraphsOwnFixingIsAsBefore) {
  GaugeScene scene(3);
  Problem& problem = scene.problem;
  ASSERT_TRUE(problem.SetFixed(scene.poses[5], Fix::kPosition).ok());
  const auto version = problem.structure_version();
  const auto identity = problem.identity();
  for (const Gauge& gauge :
       {Gauge(Gauge::Fixed{scene.poses[0]}), Gauge(Gauge::Fixed{scene.poses[5]}),
        Gauge(Gauge::FixedPoses{scene.poses[0], scene.poses[1]})}) {
    ASSERT_TRUE(problem.Solve(Converge(gauge)).ok());
    EXPECT_EQ(problem.GetFixed(scene.poses[0]), Fix::kFree);
    EXPECT_EQ(problem.GetFixed(scene.poses[1]), Fix::kFree);
    EXPECT_EQ(problem.GetFixed(scene.poses[5]), Fix::kPosition);
    ASSERT_EQ(problem.free_tangents().size(), 1u);
    EXPECT_EQ(problem.free_tangents()[0].fix, Fix::kPosition);
    EXPECT_EQ(problem.structure_version(), version);
    EXPECT_EQ(problem.identity(), identity);
  }
  const int edges = problem.NumEdges();
  ASSERT_TRUE(problem.Solve(Converge(Gauge::Prior{scene.poses[0]})).ok());
  EXPECT_EQ(problem.NumEdges(), edges);
  EXPECT_EQ(problem.GetFixed(scene.poses[0]), Fix::kFree);
}

// R0 belongs to the gauge: pulls in between, one after the other, must not turn the scene, as they
// would if each solve took its own R0 (the product of rotations without yaw has one).
TEST(GaugeSolve, R0StaysThroughManySolves) {
  GaugeScene scene(4);
  Problem& problem = scene.problem;
  const Pose start = problem.Get(scene.poses[0]).pose;
  GraphRandom random(5);
  double turned_away = 0.0;
  for (int turn = 0; turn < 30; ++turn) {
    EdgeOptions<EdgeSE3Prior> options;
    options.sqrt_information = Matrix6::Zero();
    options.sqrt_information->bottomRightCorner<3, 3>() = 3e4 * Matrix3::Identity();
    Pose pull = start;
    pull.q() = so3::ExpQuaternion(Vector3(random.NormalVector<3>(0.3))) * start.q();
    const auto edge = problem.AddEdge(EdgeSE3Prior{pull}, {scene.poses[0]}, options);
    ASSERT_TRUE(problem.Solve({.max_iterations = 5, .gauge = Gauge::Fixed{scene.poses[0]}}).ok());
    const Pose now = problem.Get(scene.poses[0]).pose;
    EXPECT_LT(std::abs(YawBetween(start, now)), 1e-12) << "turn " << turn;
    turned_away =
        std::max(turned_away, so3::Log(Quaternion(now.q() * start.q().conjugate())).norm());
    ASSERT_TRUE(problem.RemoveEdge(edge.value()).ok());
  }
  EXPECT_GT(turned_away, 0.1) << "or the test shows nothing";
}

TEST(GaugeSolve, PriorPullsToItsReferenceAtAnyWeight) {
  GaugeScene scene(6);
  Problem& problem = scene.problem;
  const Pose start = problem.Get(scene.poses[0]).pose;
  Pose reference = start;
  reference.q() = so3::ExpQuaternion(Vector3(0.0, 0.0, 0.3)) * start.q();
  reference.p() += Vector3(1.0, -2.0, 0.5);
  for (const double weight : {1e2, 1e5}) {
    const SolveSummary& summary =
        problem.Solve(Converge(Gauge::Prior{scene.poses[0], weight, reference}));
    ASSERT_TRUE(summary.ok()) << summary.status.message();
    const Pose now = problem.Get(scene.poses[0]).pose;
    EXPECT_LT((now.p() - reference.p()).norm(), 1e-6);
    EXPECT_LT(std::abs(YawBetween(reference, now)), 1e-6);
  }
}

// One camera: 7 directions. Whatever is held, the cost is that of the free solve, while two whole
// poses take 5 real degrees of freedom away.
TEST(GaugeSolve, MonoHoldsTheScaleByOneCoordinate) {
  for (const bool inverse_depth : {true, false}) {
    GaugeScene free(7, Vision(inverse_depth)), fixed(7, Vision(inverse_depth)),
        prior(7, Vision(inverse_depth)), poses(7, Vision(inverse_depth));
    const auto orbit = Orbit::Of(free.problem);
    ASSERT_TRUE(orbit.ok());
    ASSERT_EQ(orbit->group(), GaugeGroup::kMono);
    const double cost = CostIn(&free, Gauge::Free);
    const Pose a = fixed.problem.Get(fixed.poses[0]).pose;
    const Pose b = fixed.problem.Get(fixed.poses[1]).pose;
    EXPECT_NEAR(CostIn(&fixed, Gauge::Fixed{fixed.poses[0]}), cost, 1e-8 * cost);
    EXPECT_EQ(fixed.problem.Get(fixed.poses[0]).pose, a);
    const auto baseline = [&](const Pose& second) {
      return Vector3((a * fixed.T_b_c).R().transpose() *
                     ((second * fixed.T_b_c).p() - (a * fixed.T_b_c).p()));
    };
    const auto in_body = [&](const Pose& second) {
      return Vector3(fixed.T_b_c.R() * baseline(second));
    };
    int axis = 0;
    in_body(b).cwiseAbs().maxCoeff(&axis);
    const Pose b_after = fixed.problem.Get(fixed.poses[1]).pose;
    EXPECT_NEAR(in_body(b_after)[axis], in_body(b)[axis], 1e-13);
    EXPECT_GT((in_body(b_after) - in_body(b)).norm(), 1e-4) << "the other two are free";

    EXPECT_NEAR(CostIn(&prior, Gauge::Prior{prior.poses[0], 1e5}), cost, 1e-8 * cost);
    EXPECT_GT(CostIn(&poses, Gauge::FixedPoses{poses.poses[0], poses.poses[1]}), 1.02 * cost);
  }
}

TEST(GaugeSolve, StereoHoldsThePose) {
  GaugeSceneOptions options = Vision();
  options.relative_poses = true;
  GaugeScene free(8, options), fixed(8, options), prior(8, options);
  ASSERT_EQ(Orbit::Of(free.problem)->group(), GaugeGroup::kStereo);
  const double cost = CostIn(&free, Gauge::Free);
  const Pose a = fixed.problem.Get(fixed.poses[3]).pose;
  EXPECT_NEAR(CostIn(&fixed, Gauge::Fixed{fixed.poses[3]}), cost, 1e-9 * cost);
  EXPECT_EQ(fixed.problem.Get(fixed.poses[3]).pose, a);
  EXPECT_NEAR(CostIn(&prior, Gauge::Prior{prior.poses[3], 1e5}), cost, 1e-9 * cost);
}

TEST(GaugeSolve, RefusesWhatIsNotThere) {
  GaugeScene scene(9);
  Problem& problem = scene.problem;
  const auto code = [&](const Gauge& gauge) {
    const SolveSummary& summary = problem.Solve({.gauge = gauge});
    EXPECT_EQ(summary.termination, Termination::kFailed);
    return summary.status.code();
  };
  const Snapshot before = problem.GetSnapshot();
  EXPECT_EQ(code(Gauge::Fixed{}), StatusCode::kUnknownHandle);
  EXPECT_EQ(code(Gauge::FixedPoses{scene.poses[0], {}}), StatusCode::kUnknownHandle);
  EXPECT_EQ(code(Gauge::Prior{scene.poses[0], -1.0}), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(Gauge::Prior{scene.poses[0], NAN}), StatusCode::kInvalidArgument);
  Pose bad;
  bad.data[0] = NAN;
  EXPECT_EQ(code(Gauge::Fixed{scene.poses[0], bad}), StatusCode::kNotFinite);
  EXPECT_EQ(problem.GetSnapshot().states, before.states);
  GaugeScene mono(9, Vision());
  EXPECT_EQ(
      mono.problem.Solve({.gauge = Gauge::Fixed{mono.poses[0], {}, mono.poses[0]}}).status.code(),
      StatusCode::kInvalidArgument);
}

// A hold is no change of structure: one analysis serves all solves under one gauge.
TEST(GaugeSolve, SolvesUnderOneGaugeAreAnalyzedOnce) {
  GaugeScene scene(10);
  Structure structure;
  Graph& graph = scene.problem;
  FreeTangent whole;
  whole.vertex = scene.poses[2];
  whole.fix = Fix::kWhole;
  std::uint64_t first = 0;
  for (int turn = 0; turn < 3; ++turn) {
    graph.BeginHold(std::span(&whole, 1));
    EXPECT_EQ(structure.IsCurrent(graph), turn > 0);
    ASSERT_TRUE(structure.Analyze(&graph).ok());
    if (turn == 0) first = structure.analysis();
    EXPECT_EQ(structure.analysis(), first);
    graph.EndHold();
    EXPECT_FALSE(structure.IsCurrent(graph));
  }
  ASSERT_TRUE(graph.SetFixed(scene.poses[3]).ok());
  graph.BeginHold(std::span(&whole, 1));
  EXPECT_FALSE(structure.IsCurrent(graph));
  graph.EndHold();
}

// It was an edge that came and went, with an analysis of the structure in each solve.
TEST(GaugeSolve, SolvesUnderAPriorAreAnalyzedOnce) {
  GaugeScene scene(12);
  Graph& graph = scene.problem;
  SolverWorkspace workspace;
  const Gauge gauge = Gauge::Prior{scene.poses[0]};
  const auto version = graph.structure_version();
  const int edges = graph.NumEdges();
  std::uint64_t first = 0;
  double cost = 0.0;
  for (int turn = 0; turn < 3; ++turn) {
    const SolveSummary& summary = Solve(&graph, &workspace, Converge(gauge));
    ASSERT_TRUE(summary.ok()) << summary.status.message();
    EXPECT_EQ(summary.num_edges, edges + 1);
    EXPECT_EQ(graph.NumEdges(), edges);
    EXPECT_EQ(graph.structure_version(), version);
    if (turn == 0) {
      first = workspace.structure.analysis();
      cost = summary.final_cost;
    }
    EXPECT_EQ(workspace.structure.analysis(), first);
    EXPECT_NEAR(summary.final_cost, cost, 1e-9 * cost);
  }
  // Another anchor is another structure, and none of it is left when there is no gauge.
  ASSERT_TRUE(Solve(&graph, &workspace, Converge(Gauge::Prior{scene.poses[3]})).ok());
  EXPECT_NE(workspace.structure.analysis(), first);
  const SolveSummary& free = Solve(&graph, &workspace, Converge(Gauge::Free));
  EXPECT_EQ(free.num_edges, edges);
  EXPECT_NEAR(free.final_cost, cost, 1e-8 * cost);
}

// Known biases: velocities are estimated, biases stay where they are, to the bit.
TEST(GaugeSolve, KnownBiases) {
  GaugeSceneOptions options;
  options.biases = false;
  GaugeScene scene(11, options), all(11);
  const VertexSpeedBias start = scene.problem.Get(scene.speeds[4]);
  const double cost = CostIn(&scene, Gauge::Fixed{scene.poses[0]});
  const VertexSpeedBias end = scene.problem.Get(scene.speeds[4]);
  EXPECT_GT((end.v() - start.v()).norm(), 1e-3);
  EXPECT_EQ(end.ba(), start.ba());
  EXPECT_EQ(end.bg(), start.bg());
  EXPECT_GT(cost, CostIn(&all, Gauge::Fixed{all.poses[0]}));
  EXPECT_EQ(scene.problem.SetFixed(scene.poses[0], Fix::kBiases).code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(scene.problem.SetFixed(scene.poses[0], Fix::kCoordinate).code(),
            StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace glissade::test
