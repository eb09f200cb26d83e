// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "glissade/bridge/ceres.h"
#include "glissade/edges/se3_prior.h"
#include "glissade/graph/pools.h"
#include "glissade/problem/problem.h"
#include "support/random_graph.h"
#include "support/tilt_scene.h"

// What goes to Ceres, what comes back, and what is refused.

namespace glissade::bridge {
namespace {

using test::ChartAnchor;
using test::GraphKind;
using test::MakeRandomGraph;
using test::TiltScene;

/// Equal to rounding: a chart writes its rotation anew.
void ExpectSameStates(const Snapshot& a, const Snapshot& b) {
  ASSERT_EQ(a.vertices, b.vertices);
  for (std::size_t k = 0; k < a.states.size(); ++k)
    EXPECT_NEAR(a.states[k], b.states[k], 4e-16 * std::max(1.0, std::abs(b.states[k])));
}

TEST(Export, RoundTrip) {
  for (const GraphKind kind : test::kAllGraphKinds) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE(ToString(kind) + ", seed " + std::to_string(seed));
      Graph graph = MakeRandomGraph(kind, seed, {.removals = seed % 2 == 0});
      const Snapshot before = graph.GetSnapshot();
      const CeresProblem exported = Export(graph);
      ASSERT_TRUE(ReadBack(exported, &graph).ok());
      ExpectSameStates(graph.GetSnapshot(), before);
    }
  }
}

TEST(Export, EveryVertexAndEdgeIsMapped) {
  int partly_fixed = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Graph graph = MakeRandomGraph(GraphKind::kMixed, seed, {.removals = true});
    const CeresProblem exported = Export(graph);
    const ceres::Problem& problem = exported.problem();
    EXPECT_EQ(problem.NumParameterBlocks(), graph.NumVertices());
    EXPECT_EQ(problem.NumResidualBlocks(), graph.NumEdges());
    for (const AnyVertex& vertex : graph.Vertices()) {
      const VertexOps& ops = graph.PoolOf(vertex.type)->ops();
      const double* block = exported.ParameterBlock(vertex);
      ASSERT_NE(block, nullptr) << ToString(vertex);
      const Fix fix = graph.GetFixed(vertex);
      EXPECT_EQ(problem.IsParameterBlockConstant(block), fix == Fix::kWhole);
      EXPECT_EQ(problem.ParameterBlockSize(block),
                fix == Fix::kPositionAndYaw ? 2 : ops.ambient_dim);
      const int dim = fix == Fix::kPosition ? 3 : fix == Fix::kPositionAndYaw ? 2 : ops.tangent_dim;
      EXPECT_EQ(problem.ParameterBlockTangentSize(block), dim);
      EXPECT_EQ(exported.FreeDim(vertex), fix == Fix::kWhole ? 0 : dim);
      if (fix == Fix::kPosition || fix == Fix::kPositionAndYaw) ++partly_fixed;
    }
    for (const AnyEdge& edge : graph.Edges()) {
      const ceres::ResidualBlockId id = exported.ResidualBlock(edge);
      ASSERT_NE(id, nullptr) << ToString(edge);
      std::vector<double*> blocks;
      problem.GetParameterBlocksForResidualBlock(id, &blocks);
      const std::vector<AnyVertex> vertices = graph.VerticesOf(edge).value();
      ASSERT_EQ(blocks.size(), vertices.size());
      for (std::size_t i = 0; i < blocks.size(); ++i)
        EXPECT_EQ(blocks[i], exported.ParameterBlock(vertices[i]));
    }
  }
  EXPECT_GT(partly_fixed, 5);
}

TEST(Export, UnknownHandles) {
  Graph graph;
  const auto pose = graph.AddVertex(VertexPose{});
  const auto gone = graph.AddVertex(VertexPose{});
  const auto edge = graph.AddEdge(EdgeSE3Prior{}, {pose});
  ASSERT_TRUE(graph.RemoveVertex(gone.value()).ok());
  const CeresProblem exported = Export(graph);
  EXPECT_NE(exported.ParameterBlock(pose.value()), nullptr);
  EXPECT_EQ(exported.ParameterBlock(gone.value()), nullptr);
  EXPECT_EQ(exported.ParameterBlock(AnyVertex()), nullptr);
  EXPECT_EQ(exported.ParameterBlock(VertexHandle<VertexPointXYZ>{0, 0}), nullptr);
  EXPECT_TRUE(exported.State(gone.value()).empty());
  EXPECT_EQ(exported.FreeDim(gone.value()), 0);
  EXPECT_EQ(exported.ResidualBlock(AnyEdge()), nullptr);
  EXPECT_NE(exported.ResidualBlock(edge.value()), nullptr);
}

TEST(Export, StandsOnItsOwn) {
  std::optional<Graph> graph(MakeRandomGraph(GraphKind::kMixed, 3));
  const Snapshot before = graph->GetSnapshot();
  CeresProblem exported = Export(*graph);
  double cost = 0.0;
  ASSERT_TRUE(exported.problem().Evaluate({}, &cost, nullptr, nullptr, nullptr));
  EXPECT_NEAR(cost, graph->Cost().value(), 1e-12 * cost);

  ceres::Solver::Options options;
  options.linear_solver_ordering = exported.MakeOrdering();
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.max_num_iterations = 3;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &exported.problem(), &summary);
  EXPECT_LT(summary.final_cost, cost);
  // Nothing of this has reached the graph.
  EXPECT_EQ(graph->GetSnapshot().states, before.states);

  CeresProblem moved = std::move(exported);
  graph.reset();
  double again = 0.0;
  ASSERT_TRUE(moved.problem().Evaluate({}, &again, nullptr, nullptr, nullptr));
  EXPECT_NEAR(again, summary.final_cost, 1e-12 * again);
}

TEST(Export, EliminatedVerticesAreGroupZero) {
  const Graph graph = MakeRandomGraph(GraphKind::kMixed, 4);
  const CeresProblem exported = Export(graph);
  const auto ordering = exported.MakeOrdering();
  ASSERT_NE(ordering, nullptr);
  EXPECT_EQ(ordering->NumElements(), graph.NumVertices());
  int eliminated = 0;
  for (const AnyVertex& vertex : graph.Vertices()) {
    const VertexPoolBase& pool = *graph.PoolOf(vertex.type);
    const bool is_eliminated =
        pool.eliminated(pool.slots().IndexOf(vertex.slot)) && graph.GetFixed(vertex) != Fix::kWhole;
    EXPECT_EQ(ordering->GroupId(exported.ParameterBlock(vertex)), is_eliminated ? 0 : 1);
    eliminated += is_eliminated ? 1 : 0;
  }
  EXPECT_GT(eliminated, 5);
  EXPECT_EQ(Export(MakeRandomGraph(GraphKind::kPoseGraph, 4)).MakeOrdering(), nullptr);
}

TEST(ReadBack, BringsTheOptimumAndWhatWasHeldStays) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Graph graph = MakeRandomGraph(GraphKind::kMixed, seed);
    const Graph before = graph.Clone();
    CeresProblem exported = Export(graph);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_SCHUR;
    options.linear_solver_ordering = exported.MakeOrdering();
    ceres::Solver::Summary summary;
    ceres::Solve(options, &exported.problem(), &summary);
    ASSERT_TRUE(summary.IsSolutionUsable());
    ASSERT_TRUE(ReadBack(exported, &graph).ok());
    EXPECT_NEAR(graph.Cost().value(), summary.final_cost, 1e-12 * summary.final_cost);
    EXPECT_LT(graph.Cost().value(), 0.9 * before.Cost().value());
    for (const AnyVertex& vertex : graph.Vertices()) {
      const VertexPoolBase& pool = *graph.PoolOf(vertex.type);
      const double* now = pool.Data(pool.slots().IndexOf(vertex.slot));
      const double* then = before.PoolOf(vertex.type)->Data(pool.slots().IndexOf(vertex.slot));
      const std::vector<double> state = exported.State(vertex);
      EXPECT_TRUE(std::equal(state.begin(), state.end(), now));
      const Fix fix = graph.GetFixed(vertex);
      if (fix == Fix::kWhole) {
        EXPECT_TRUE(std::equal(state.begin(), state.end(), then));
      }
      if (fix == Fix::kPosition || fix == Fix::kPositionAndYaw) {
        EXPECT_TRUE(std::equal(now, now + 3, then));
      }
    }
  }
}

// The gauge chart comes back too: a solve after ReadBack continues in the same chart.
TEST(ReadBack, YawStaysHeld) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    TiltScene<ChartAnchor> scene(seed, 0.1);
    TiltScene<ChartAnchor> ours(seed, 0.1);
    ceres::Solver::Options ceres_options;
    ceres_options.linear_solver_type = ceres::DENSE_SCHUR;
    const ceres::Solver::Summary summary = SolveWithCeres(&scene.problem, ceres_options);
    ASSERT_EQ(summary.termination_type, ceres::CONVERGENCE);
    EXPECT_LT(std::abs(test::YawSince(scene.start, scene.Now())), 1e-12);
    EXPECT_EQ(scene.Now().p(), scene.start.p());
    SolveOptions options;
    options.cost_tolerance = 1e-14;
    ASSERT_TRUE(scene.problem.Solve(options).converged());
    const double cost = scene.problem.Cost().value();
    EXPECT_LT(std::abs(test::YawSince(scene.start, scene.Now())), 1e-12);
    ASSERT_TRUE(ours.problem.Solve(options).converged());
    EXPECT_NEAR(cost, ours.problem.Cost().value(), 1e-10 * cost);
    const double* dphi = scene.problem.free_tangents()[0].dphi;
    const double* own_dphi = ours.problem.free_tangents()[0].dphi;
    EXPECT_GT(std::hypot(dphi[0], dphi[1]), 0.05);
    EXPECT_NEAR(dphi[0], own_dphi[0], 1e-6);
    EXPECT_NEAR(dphi[1], own_dphi[1], 1e-6);
    EXPECT_EQ(dphi[2], 0.0);
  }
}

TEST(ReadBack, Refusals) {
  Graph graph = MakeRandomGraph(GraphKind::kMonoWindow, 2, {.fixes = false});
  const CeresProblem exported = Export(graph);
  EXPECT_EQ(ReadBack(exported, nullptr).code(), StatusCode::kInvalidArgument);

  const Snapshot before = graph.GetSnapshot();
  const AnyVertex vertex = graph.Vertices()[2];
  const double saved = exported.ParameterBlock(vertex)[1];
  exported.ParameterBlock(graph.Vertices()[0])[0] += 1.0;
  exported.ParameterBlock(vertex)[1] = std::numeric_limits<double>::quiet_NaN();
  Status status = ReadBack(exported, &graph);
  EXPECT_EQ(status.code(), StatusCode::kNotFinite);
  EXPECT_EQ(status.vertex(), vertex);
  EXPECT_EQ(graph.GetSnapshot().states, before.states);

  exported.ParameterBlock(vertex)[1] = saved;
  ASSERT_TRUE(graph.RemoveVertex(vertex).ok());
  const Snapshot reduced = graph.GetSnapshot();
  status = ReadBack(exported, &graph);
  EXPECT_EQ(status.code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(status.vertex(), vertex);
  EXPECT_EQ(graph.GetSnapshot().states, reduced.states);
}

TEST(ReadBack, LeavesNewVerticesAlone) {
  Graph graph = MakeRandomGraph(GraphKind::kMonoWindow, 2, {.fixes = false});
  const CeresProblem exported = Export(graph);
  const AnyVertex first = graph.Vertices()[0];
  exported.ParameterBlock(first)[0] += 1.0;
  VertexPose value;
  value.pose.p() = Vector3(7.0, 8.0, 9.0);
  const VertexHandle<VertexPose> added = graph.AddVertex(value);
  ASSERT_TRUE(ReadBack(exported, &graph).ok());
  EXPECT_EQ(graph.Get(added).pose, value.pose);
  const VertexPoolBase& pool = *graph.PoolOf(first.type);
  EXPECT_EQ(pool.Data(pool.slots().IndexOf(first.slot))[0], exported.ParameterBlock(first)[0]);
}

TEST(SolveWithCeres, EveryLinearSolver) {
  std::optional<double> cost;
  for (const ceres::LinearSolverType type :
       {ceres::DENSE_QR, ceres::DENSE_NORMAL_CHOLESKY, ceres::SPARSE_NORMAL_CHOLESKY,
        ceres::DENSE_SCHUR, ceres::SPARSE_SCHUR, ceres::ITERATIVE_SCHUR}) {
    SCOPED_TRACE(ceres::LinearSolverTypeToString(type));
    Graph graph = MakeRandomGraph(GraphKind::kMixed, 6);
    ceres::Solver::Options options;
    options.linear_solver_type = type;
    options.function_tolerance = 1e-12;
    options.max_num_iterations = 200;
    const ceres::Solver::Summary summary = SolveWithCeres(&graph, options);
    EXPECT_EQ(summary.termination_type, ceres::CONVERGENCE) << summary.BriefReport();
    if (!cost) cost = summary.final_cost;
    EXPECT_NEAR(graph.Cost().value(), *cost, 1e-8 * *cost);
  }
}

TEST(SolveWithCeres, FailureLeavesTheGraph) {
  EXPECT_EQ(SolveWithCeres(nullptr).termination_type, ceres::FAILURE);

  Graph graph;
  const VertexHandle<VertexPose> pose = graph.AddVertex(VertexPose{});
  const VertexHandle<VertexPointXYZ> point = graph.AddVertex(VertexPointXYZ(1.0, 1.0, 3.0));
  // A point in the plane of the camera has no projection.
  const VertexHandle<VertexPointXYZ> beside = graph.AddVertex(VertexPointXYZ(1.0, 1.0, 0.0));
  ASSERT_TRUE(graph.AddEdge(EdgeReprojectionXYZ{}, {pose, point}).ok());
  ASSERT_TRUE(graph.AddEdge(EdgeReprojectionXYZ{}, {pose, beside}).ok());
  const Snapshot before = graph.GetSnapshot();
  const ceres::Solver::Summary summary = SolveWithCeres(&graph);
  EXPECT_FALSE(summary.IsSolutionUsable());
  EXPECT_EQ(graph.GetSnapshot().states, before.states);
}

TEST(SolveWithCeres, NothingToSolve) {
  Graph graph;
  EXPECT_TRUE(SolveWithCeres(&graph).IsSolutionUsable());
  const VertexHandle<VertexPose> pose = graph.AddVertex(VertexPose{});
  ASSERT_TRUE(graph.SetFixed(pose).ok());
  EXPECT_TRUE(SolveWithCeres(&graph).IsSolutionUsable());
}

TEST(Linearize, Refusals) {
  Graph graph = MakeRandomGraph(GraphKind::kMonoWindow, 2, {.fixes = false});
  std::vector<AnyVertex> order = graph.Vertices();
  ASSERT_TRUE(graph.SetFixed(order[0]).ok());
  const CeresProblem exported = Export(graph);
  EXPECT_EQ(Linearize(exported, {}).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(Linearize(exported, order).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(Linearize(exported, order).status().vertex(), order[0]);
  order.erase(order.begin());
  EXPECT_TRUE(Linearize(exported, order).ok());
  order.emplace_back();
  EXPECT_EQ(Linearize(exported, order).status().code(), StatusCode::kUnknownHandle);
}

}  // namespace
}  // namespace glissade::bridge
