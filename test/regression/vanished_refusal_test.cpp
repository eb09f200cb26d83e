// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A refused call could vanish: a chain of unchecked calls with a NaN in it ended in a graph without
// edges, which "converged" with cost 0.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "glissade/minimizer/minimizer.h"
#include "glissade/problem/problem.h"
#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(VanishedRefusal, AnUncheckedChainWithANanDepthFailsInSolve) {
  Problem problem;
  const auto a = problem.AddVertex(VertexPose());
  const auto b = problem.AddVertex(VertexPose());
  const auto depth = problem.AddVertex(VertexInverseDepth{kNan});
  (void)problem.AddEdge(EdgeReprojection(), {a, b, depth});
  (void)problem.SetFixed(a);
  const SolveSummary& summary = problem.Solve();
  EXPECT_FALSE(summary.ok());
  EXPECT_FALSE(summary.converged());
  EXPECT_EQ(summary.status.code(), StatusCode::kNotFinite) << "of the first refusal";
  EXPECT_NE(summary.status.message().find("VertexInverseDepth"), std::string::npos)
      << summary.status.message();
  EXPECT_NE(summary.status.message().find("AcknowledgeRefusal"), std::string::npos);
  EXPECT_FALSE(problem.Solve().ok()) << "until it is acknowledged";
  EXPECT_EQ(problem.AcknowledgeRefusal().code(), StatusCode::kNotFinite);
  EXPECT_TRUE(problem.first_refusal().ok());
  EXPECT_EQ(problem.Solve().status.code(), StatusCode::kNothingToSolve);
}

TEST(VanishedRefusal, TheFreeFunctionSaysTheSame) {
  Graph graph;
  SolverWorkspace workspace;
  EXPECT_EQ(Solve(&graph, &workspace, {}).status.code(), StatusCode::kNothingToSolve);
  AddWindow(&graph);
  EXPECT_TRUE(Solve(&graph, &workspace, {.max_iterations = 2}).ok());
  (void)graph.AddVertex(VertexInverseDepth{kNan});
  EXPECT_EQ(Solve(&graph, &workspace, {.max_iterations = 2}).status.code(), StatusCode::kNotFinite);
}

TEST(VanishedRefusal, EveryCallThatIsToChangeSomethingIsRemembered) {
  Problem base;
  const Window w = AddWindow(&base);
  const auto pose = w.poses[2];
  const auto edge = w.edges[0];
  const Matrix2 nan = kNan * Matrix2::Ones();
  using Call = std::pair<std::string, std::function<Status(Problem&)>>;
  const std::vector<Call> calls{
      {"AddVertex", [&](Problem& p) { return p.AddVertex(VertexInverseDepth{kNan}).status(); }},
      {"AddVertices",
       [&](Problem& p) {
         const std::vector<VertexInverseDepth> values{{0.1}, {kNan}};
         return p.AddVertices(std::span(values)).status();
       }},
      {"AddEdge", [&](Problem& p) { return p.AddEdge(EdgeSE3Prior(), {{}}).status(); }},
      {"AddEdges",
       [&](Problem& p) {
         const std::vector<EdgeSE3Prior> edges(1);
         const std::vector<EdgeVertexHandles<EdgeSE3Prior>> on(1);
         return p.AddEdges(std::span(edges), std::span(on)).status();
       }},
      {"AddEdge, dynamic",
       [&](Problem& p) {
         return p.AddEdge(std::unique_ptr<DynamicEdge>(), std::span<const AnyVertex>()).status();
       }},
      {"RemoveVertex", [&](Problem& p) { return p.RemoveVertex(AnyVertex()); }},
      {"RemoveEdge", [&](Problem& p) { return p.RemoveEdge(AnyEdge()); }},
      {"Set", [&](Problem& p) { return p.Set(w.landmarks[0], VertexInverseDepth{kNan}); }},
      {"SetFixed", [&](Problem& p) { return p.SetFixed(w.landmarks[0], Fix::kPosition); }},
      {"SetFixed, no Fix", [&](Problem& p) { return p.SetFixed(pose, static_cast<Fix>(77)); }},
      {"SetEliminated", [&](Problem& p) { return p.SetEliminated(pose, true); }},
      {"SetFirstEstimate", [&](Problem& p) { return p.SetFirstEstimate(pose, {}); }},
      {"SetInformation", [&](Problem& p) { return p.SetInformation(edge, nan); }},
      {"SetSqrtInformation", [&](Problem& p) { return p.SetSqrtInformation(edge, nan); }},
      {"SetLoss", [&](Problem& p) { return p.SetLoss(edge, Huber{-1.0}); }},
      {"RestoreSnapshot", [&](Problem& p) { return p.RestoreSnapshot(Snapshot()); }},
      {"Marginalize", [&](Problem& p) { return p.Marginalize({AnyVertex()}).status(); }},
      {"MoveToGauge", [&](Problem& p) { return p.MoveToGauge(Gauge::Fixed{}); }},
      {"MoveAlongOrbit",
       [&](Problem& p) {
         OrbitMotion g;
         g.scale = kNan;
         return MoveAlongOrbit(&p, g);
       }},
  };
  for (const auto& [name, call] : calls) {
    SCOPED_TRACE(name);
    Problem problem = base.Clone();
    const Status refused = call(problem);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(problem.first_refusal().message(), refused.message());
    (void)problem.RemoveVertex(AnyVertex());  // a second one does not take its place
    EXPECT_EQ(problem.first_refusal().message(), refused.message());

    Problem copy = problem.Clone();
    EXPECT_EQ(copy.first_refusal().message(), refused.message()) << "a copy has it too";
    Problem moved = std::move(copy);
    EXPECT_EQ(moved.first_refusal().message(), refused.message());
    EXPECT_TRUE(copy.first_refusal().ok());  // NOLINT: use after move

    const SolveSummary& summary = problem.Solve({.max_iterations = 2});
    EXPECT_EQ(summary.status.code(), refused.code());
    EXPECT_EQ(summary.status.vertex(), refused.vertex());
    EXPECT_EQ(summary.status.edge(), refused.edge());
    problem.AcknowledgeRefusal();
    EXPECT_TRUE(problem.Solve({.max_iterations = 2}).ok());
  }
}

TEST(VanishedRefusal, QueriesAndSolvesThatFailAreNotRemembered) {
  Problem problem;
  const Window w = AddWindow(&problem);
  EXPECT_FALSE(problem.Chi2(AnyEdge()).ok());
  EXPECT_FALSE(problem.EdgesOf(AnyVertex()).ok());
  EXPECT_FALSE(problem.ComputeCovariance(std::vector<AnyVertex>{AnyVertex()}).ok());
  EXPECT_FALSE(problem.ComputeMarginalPrior(std::vector<AnyVertex>{AnyVertex()}).ok());
  SolveOptions options;
  options.gauge = Gauge::Fixed{};
  EXPECT_FALSE(problem.Solve(options).ok());
  EXPECT_FALSE(problem.Solve({.max_iterations = -1}).ok());
  EXPECT_TRUE(problem.first_refusal().ok()) << problem.first_refusal().message();
  EXPECT_TRUE(problem.Solve({.max_iterations = 2}).ok());
}

TEST(VanishedRefusal, WithoutEdgesThereIsNothingToSolve) {
  Problem problem;
  EXPECT_EQ(problem.Solve().status.code(), StatusCode::kNothingToSolve);
  EXPECT_FALSE(problem.Solve().converged());
  const auto pose = problem.AddVertex(VertexPose());
  EXPECT_EQ(problem.Solve().status.code(), StatusCode::kNothingToSolve);
  const auto prior = problem.AddEdge(EdgeSE3Prior(), {pose});
  EXPECT_TRUE(problem.Solve().converged());
  // Edges that went with their vertices, and edges that were removed, before the next analysis.
  ASSERT_TRUE(problem.RemoveEdge(prior.value()).ok());
  EXPECT_EQ(problem.Solve().status.code(), StatusCode::kNothingToSolve);
  ASSERT_TRUE(problem.AddEdge(EdgeSE3Prior(), {pose}).ok());
  ASSERT_TRUE(problem.RemoveVertex(pose).ok());
  EXPECT_EQ(problem.Solve().status.code(), StatusCode::kNothingToSolve);
}

TEST(VanishedRefusal, WhereNothingIsFreeThePresentValuesAreTheBest) {
  for (const bool unconnected : {false, true}) {
    for (const Method method : {Method::kLevenbergMarquardt, Method::kDogleg}) {
      Problem problem;
      const auto pose = problem.AddVertex(VertexPose()).value();
      Pose there;
      there.data[0] = 3.0;
      ASSERT_TRUE(problem.AddEdge(EdgeSE3Prior{there}, {pose}).ok());
      ASSERT_TRUE(problem.SetFixed(pose).ok());
      if (unconnected) {
        ASSERT_TRUE(problem.AddVertex(VertexInverseDepth{0.5}).ok());
      }
      SolveOptions options;
      options.method = method;
      const SolveSummary& summary = problem.Solve(options);
      EXPECT_EQ(summary.termination, Termination::kConvergedGradient) << summary.BriefReport();
      EXPECT_EQ(summary.accepted_steps + summary.rejected_steps, 0);
      EXPECT_EQ(summary.final_cost, 4.5);
      EXPECT_EQ(summary.initial_cost, 4.5);
    }
  }
}

}  // namespace
}  // namespace glissade::test
