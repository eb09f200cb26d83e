// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "common/random_states.h"
#include "glissade/io/g2o.h"
#include "glissade/losses/huber.h"
#include "glissade/problem/problem.h"
#include "glissade/vertices/vector.h"
#include "io/temp_file.h"
#include "support/g2o_scene.h"

// What the numbers of g2o's files mean: costs against g2o's formulas, written down once more with
// Eigen's transforms (support/g2o_scene.h), and optima.

namespace glissade {
namespace {

using test::G2oChi2;
using test::Random;

std::array<double, 21> RandomInformation(Random& random) {
  Eigen::Matrix<double, 6, 6> a;
  for (int i = 0; i < 36; ++i)
    a(i / 6, i % 6) = random.Uniform(-1.0, 1.0);
  const Eigen::Matrix<double, 6, 6> omega = a.transpose() * a;
  std::array<double, 21> triangle{};
  int k = 0;
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c)
      triangle[static_cast<std::size_t>(k++)] = omega(r, c);
  }
  return triangle;
}

/// Two poses and an edge between them whose rotation error is `angle`, and a prior of such a kind
/// with a turned sensor.
G2oProblem PoseEdges(Random& random, double angle) {
  G2oProblem p;
  p.offsets.push_back({4, Pose(random.Rotation(), Vector3::Zero())});
  const Pose T_w_i = random.RandomPose(3.0), T_i_j = random.RandomPose(3.0);
  const Pose error(random.Rotation(angle), random.Vec3(0.5));
  p.poses.push_back({10, T_w_i, false});
  p.poses.push_back({11, T_w_i * T_i_j * error, false});
  for (G2oPose& pose : p.poses)
    pose.T_w_b.Normalize();
  p.relative_poses.push_back({10, 11, T_i_j, RandomInformation(random)});
  const Pose T_w_s = p.poses[1].T_w_b * p.offsets[0].T_b_s;
  p.priors.push_back(
      {11, 4, T_w_s * Pose(random.Rotation(angle), random.Vec3(0.5)), RandomInformation(random)});
  p.priors[0].T_w_s.Normalize();
  return p;
}

TEST(G2oGraph, PoseEdgesHaveG2osChi2ToSecondOrder) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    for (const double angle : {0.0, 1e-3, 1e-2, 0.1}) {
      const G2oProblem p = PoseEdges(random, angle);
      Graph graph;
      const auto handles = AddToGraph(p, graph);
      ASSERT_TRUE(handles.ok()) << handles.status().message();
      // Exact where nothing is turned. Else the vector part of the error falls short of half its
      // angle by the part angle^2 / 24, and so does no product of two of them by more than twice.
      const double tolerance = 1e-12 + angle * angle;
      const double edge = G2oChi2(p, p.relative_poses[0]);
      EXPECT_NEAR(graph.Chi2(handles->relative_poses[0]).value(), edge, tolerance * (1.0 + edge));
      const double prior = G2oChi2(p, p.priors[0]);
      EXPECT_NEAR(graph.Chi2(handles->priors[0]).value(), prior, tolerance * (1.0 + prior));
    }
  }
}

TEST(G2oGraph, ARotationWeighsMoreThanG2osByTheFactorThatIsDocumented) {
  Random random(2);
  for (const double angle : {0.1, 1.0, 2.5}) {
    G2oProblem p = PoseEdges(random, angle);
    p.relative_poses[0].information.fill(0.0);
    for (const std::size_t k : {15u, 18u, 20u})  // the diagonal of rotation
      p.relative_poses[0].information[k] = 7.0;
    Graph graph;
    const auto handles = AddToGraph(p, graph);
    ASSERT_TRUE(handles.ok()) << handles.status().message();
    const double ratio = std::pow(0.5 * angle / std::sin(0.5 * angle), 2);
    EXPECT_NEAR(graph.Chi2(handles->relative_poses[0]).value(),
                ratio * G2oChi2(p, p.relative_poses[0]), 1e-12);
  }
}

TEST(G2oGraph, PointsAndProjectionsHaveG2osChi2) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    G2oProblem p;
    p.offsets.push_back({0, random.RandomPose(1.0)});
    p.poses.push_back({1, random.RandomPose(2.0), false});
    p.cameras.push_back({2, random.RandomPose(2.0), 500.0, 480.0, 320.0, 240.0, 0.1, false});
    const Vector3 x = random.Vec3(5.0);
    p.points.push_back({3, {x[0], x[1], x[2]}, false, false});
    p.point_measurements.push_back({1, 3, 0, {1.0, 2.0, 3.0}, {5.0, 1.0, -1.0, 4.0, 0.5, 3.0}});
    p.projections.push_back({3, 2, 100.0, 200.0, {2.0, 0.5, 1.0}});
    Graph graph;
    const auto handles = AddToGraph(p, graph);
    ASSERT_TRUE(handles.ok()) << handles.status().message();
    const double point = G2oChi2(p, p.point_measurements[0]);
    EXPECT_NEAR(graph.Chi2(handles->point_measurements[0]).value(), point, 1e-12 * point);
    const double projection = G2oChi2(p, p.projections[0]);
    EXPECT_NEAR(graph.Chi2(handles->projections[0]).value(), projection, 1e-9 * projection);
  }
}

TEST(G2oGraph, WhatNoEdgeOfOursMeasuresIsRefused) {
  Random random(4);
  const auto refused = [](const G2oProblem& p, const char* what) {
    Graph graph;
    const auto handles = AddToGraph(p, graph);
    ASSERT_FALSE(handles.ok());
    EXPECT_NE(handles.status().message().find(what), std::string::npos)
        << handles.status().message();
    EXPECT_EQ(graph.NumVertices() + graph.NumEdges(), 0);
    EXPECT_TRUE(graph.first_refusal().ok());
  };
  G2oProblem p = PoseEdges(random, 0.1);
  p.offsets[0].T_b_s.data[1] = 0.1;
  refused(p, "EDGE_SE3_PRIOR of vertex 11: its sensor, PARAMS_SE3OFFSET 4, is not at");
  p = PoseEdges(random, 0.1);
  p.cameras.push_back({5, Pose(), 0.0, 1.0, 0.0, 0.0, 0.0, false});
  refused(p, "VERTEX_CAM 5: focal length fx");
  Graph graph;
  EXPECT_FALSE(AddToGraph(PoseEdges(random, 0.1), graph, {.loss = Huber{-1.0}}).ok());
  EXPECT_EQ(graph.NumVertices(), 0);
}

TEST(G2oGraph, HoldsTheFirstPoseWhereNothingElseHolds) {
  Random random(5);
  G2oProblem p = PoseEdges(random, 0.1);
  const auto held = [](const G2oProblem& problem, bool hold_first = true) {
    Graph graph;
    const auto handles = AddToGraph(problem, graph, {.hold_first = hold_first});
    EXPECT_TRUE(handles.ok()) << handles.status().message();
    EXPECT_EQ(graph.GetFixed(handles->poses[0]) == Fix::kWhole,
              handles->held == problem.poses[0].id || problem.poses[0].fixed);
    return handles->held;
  };
  EXPECT_EQ(held(p), -1);  // a prior
  p.priors.clear();
  EXPECT_EQ(held(p), 10);
  EXPECT_EQ(held(p, false), -1);
  p.poses[1].fixed = true;
  EXPECT_EQ(held(p), -1);
}

/// 1/2 of g2o's chi2 with rotations as we have them, as a function of all free poses and points.
TEST(G2oGraph, TheGradientAtTheOptimumVanishes) {
  const G2oProblem start = test::MakeG2oScene(40, 6);
  Problem problem;
  const auto handles = AddToGraph(start, problem);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  EXPECT_NEAR(problem.Cost().value(), test::OurG2oCost(start), 1e-9 * test::OurG2oCost(start));
  const SolveSummary& summary = problem.Solve({.max_iterations = 100, .cost_tolerance = 1e-14});
  ASSERT_TRUE(summary.ok()) << summary.status.message();
  G2oProblem solved = start;
  ASSERT_TRUE(UpdateFromGraph(problem, *handles, &solved).ok());
  EXPECT_LT(summary.final_cost, 0.05 * summary.initial_cost);
  EXPECT_NEAR(test::OurG2oCost(solved), summary.final_cost, 1e-9 * summary.final_cost);
  const auto largest_gradient = [](const G2oProblem& at) {
    double largest = 0.0;
    const auto derivative = [&](const std::function<void(G2oProblem&, double)>& move) {
      constexpr double kStep = 1e-5;
      G2oProblem plus = at, minus = at;
      move(plus, kStep);
      move(minus, -kStep);
      const double d = (test::OurG2oCost(plus) - test::OurG2oCost(minus)) / (2.0 * kStep);
      largest = std::max(largest, std::abs(d));
    };
    for (std::size_t k = 1; k < at.poses.size(); ++k) {  // the first is held
      for (int i = 0; i < 6; ++i) {
        derivative([&](G2oProblem& p, double step) {
          Vector6 delta = Vector6::Zero();
          delta[i] = step;
          VertexPose moved{p.poses[k].T_w_b};
          moved.Plus(delta.data());
          p.poses[k].T_w_b = moved.pose;
        });
      }
    }
    for (std::size_t k = 0; k < at.points.size(); ++k) {
      for (int i = 0; i < 3; ++i)
        derivative([&](G2oProblem& p, double step) { p.points[k].xyz[i] += step; });
    }
    return largest;
  };
  EXPECT_LT(largest_gradient(solved), 1e-7 * largest_gradient(start));
}

TEST(G2oGraph, WhatIsHeldKeepsItsNumbersInTheFile) {
  TempFiles files;
  G2oProblem problem = test::MakeG2oScene(20, 7);
  // Not of unit length, as files have it, and of either sign.
  for (std::size_t k = 0; k < problem.poses.size(); ++k) {
    for (int i = 3; i < 7; ++i)
      problem.poses[k].T_w_b.data[i] *= (k % 3 == 0 ? -1.0 : 1.0) * 1.001;
  }
  problem.points[2].fixed = true;
  problem.poses[4].fixed = true;
  Problem graph;
  const auto handles = AddToGraph(problem, graph);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  EXPECT_EQ(handles->held, -1);
  ASSERT_TRUE(graph.Solve().ok());
  G2oProblem solved = problem;
  ASSERT_TRUE(UpdateFromGraph(graph, *handles, &solved).ok());
  EXPECT_EQ(solved.poses[4], problem.poses[4]);
  EXPECT_EQ(solved.points[2], problem.points[2]);
  EXPECT_NE(solved.poses[5], problem.poses[5]);
  EXPECT_GT(solved.poses[6].T_w_b.q().dot(problem.poses[6].T_w_b.q()), 0.5);
  ASSERT_TRUE(WriteG2o(solved, files.Path("a.g2o")).ok());
  const auto again = ReadG2o(files.Path("a.g2o"));
  ASSERT_TRUE(again.ok()) << again.status().message();
  EXPECT_TRUE(solved == *again);
  Graph from_file;
  ASSERT_TRUE(AddToGraph(*again, from_file).ok());
  EXPECT_NEAR(from_file.Cost().value(), graph.Cost().value(), 1e-12 * graph.Cost().value());

  G2oProblem other = problem;
  other.poses.pop_back();
  EXPECT_FALSE(UpdateFromGraph(graph, *handles, &other).ok());
  EXPECT_EQ(UpdateFromGraph(from_file, *handles, &problem).code(), StatusCode::kUnknownHandle);
}

TEST(G2oGraph, AGraphOfOnesOwnBecomesAFileOfTheSameCost) {
  TempFiles files;
  const G2oProblem scene = test::MakeG2oScene(20, 9);
  Problem problem;
  const auto handles = AddToGraph(scene, problem);
  ASSERT_TRUE(handles.ok());
  Random random(10);
  for (int k = 0; k < 3; ++k) {
    Matrix6 root;
    for (int i = 0; i < 36; ++i)
      root(i / 6, i % 6) = random.Uniform(-1.0, 1.0);
    ASSERT_TRUE(problem.AddEdge(EdgeSE3Prior{random.RandomPose(3.0)}, {handles->poses[k + 5u]},
                                {.sqrt_information = root}));
  }
  // Unit weights, and a gap where a vertex was.
  ASSERT_TRUE(problem.AddEdge(EdgeRelativePose{random.RandomPose(2.0)},
                              {handles->poses[0], handles->poses[9]}));
  ASSERT_TRUE(problem.RemoveVertex(handles->poses[12]).ok());
  ASSERT_TRUE(problem.RemoveVertex(handles->points[1]).ok());

  const auto written = G2oFromGraph(problem);
  ASSERT_TRUE(written.ok()) << written.status().message();
  EXPECT_EQ(written->poses.size(), 19u);
  EXPECT_EQ(written->points.size(), 4u);
  EXPECT_EQ(written->points[0].id, 19);
  EXPECT_EQ(written->offsets.size(), 2u);  // that of the scene, and none
  EXPECT_TRUE(written->poses[0].fixed);
  ASSERT_TRUE(WriteG2o(*written, files.Path("a.g2o")).ok());
  const auto read = ReadG2o(files.Path("a.g2o"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_TRUE(*read == *written);
  Graph again;
  const auto readded = AddToGraph(*read, again);
  ASSERT_TRUE(readded.ok()) << readded.status().message();
  EXPECT_NEAR(again.Cost().value(), problem.Cost().value(), 1e-9 * problem.Cost().value());
  EXPECT_EQ(again.NumEdges(), problem.NumEdges());
  // And the same once more, but for rounding.
  const auto twice = G2oFromGraph(again);
  ASSERT_TRUE(twice.ok());
  EXPECT_TRUE(twice->poses == written->poses && twice->points == written->points);
  for (std::size_t k = 0; k < written->priors.size(); ++k) {
    for (std::size_t i = 0; i < 21; ++i)
      EXPECT_NEAR(twice->priors[k].information[i], written->priors[k].information[i], 1e-12);
  }

  ASSERT_TRUE(problem.SetFixed(handles->poses[3], Fix::kPosition).ok());
  EXPECT_EQ(G2oFromGraph(problem).status().vertex(), AnyVertex(handles->poses[3]));
  Graph other;
  ASSERT_TRUE(other.AddVertex(VertexVector<3>()).ok());
  EXPECT_EQ(G2oFromGraph(other).status().code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(G2oFromGraph(Graph()).value() == G2oProblem());
}

}  // namespace
}  // namespace glissade
