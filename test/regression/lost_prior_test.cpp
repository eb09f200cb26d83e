// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Marginal priors that were lost or left half removed: RemoveVertex() of a vertex under a prior
// took the whole prior and said ok, and Clone() after two marginalizations without a solve in
// between read the edge that the second one had taken for its storage.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "glissade/edges/marginal_prior.h"
#include "glissade/marginal/drift.h"
#include "glissade/problem/problem.h"
#include "graph/toy_graphs.h"
#include "support/vi_walk.h"

namespace glissade::test {
namespace {

TEST(LostPrior, RemoveVertexUnderAPriorIsRefusedAndPointsToMarginalize) {
  Problem problem;
  const Window w = AddWindow(&problem);
  const auto done = problem.Marginalize({w.poses[0]});
  ASSERT_TRUE(done.ok()) << done.status().message();
  const AnyEdge prior = *done;
  const std::vector<AnyVertex> under = Must(problem.VerticesOf(prior));
  ASSERT_GT(under.size(), 2u);
  const int num_vertices = problem.NumVertices(), num_edges = problem.NumEdges();
  const std::uint64_t version = problem.structure_version();
  for (const AnyVertex& vertex : under) {
    const Status status = problem.RemoveVertex(vertex);
    EXPECT_EQ(status.code(), StatusCode::kUnderPrior) << status.message();
    EXPECT_EQ(status.vertex(), vertex);
    EXPECT_EQ(status.edge(), prior);
    EXPECT_NE(status.message().find("Marginalize"), std::string::npos) << status.message();
  }
  EXPECT_EQ(problem.NumVertices(), num_vertices);
  EXPECT_EQ(problem.NumEdges(), num_edges);
  EXPECT_EQ(problem.structure_version(), version);
  EXPECT_TRUE(problem.Contains(prior));
  problem.AcknowledgeRefusal();
  EXPECT_TRUE(problem.Solve({.max_iterations = 2}).ok());

  // A vertex beside the prior goes as before.
  const auto beside = problem.AddVertex(VertexPose());
  ASSERT_TRUE(problem.AddEdge(EdgeSE3Prior(), {beside}).ok());
  EXPECT_TRUE(problem.RemoveVertex(beside).ok());

  // On purpose.
  EXPECT_TRUE(problem.RemoveVertex(under[1], PriorOnVertex::kRemove).ok());
  EXPECT_FALSE(problem.Contains(prior));
  EXPECT_FALSE(problem.HasFirstEstimate(under[0]));
  EXPECT_TRUE(problem.RemoveVertex(under[0]).ok()) << "no prior any more";
}

// A linearization point alone is no prior, and a prior counts without one.
TEST(LostPrior, ItIsThePriorThatCounts) {
  Graph graph;
  const auto pose = graph.AddVertex(VertexPose()).value();
  const double x_lin[] = {0, 0, 0, 0, 0, 0, 1};
  ASSERT_TRUE(graph.SetFirstEstimate(pose, x_lin).ok());
  EXPECT_TRUE(graph.RemoveVertex(pose).ok());

  Problem problem;
  const Window w = AddWindow(&problem);
  const auto other = problem.Clone();
  ASSERT_TRUE(problem.Marginalize({w.poses[0], w.landmarks[0]}).ok());
  // A snapshot without first estimates, of the vertices that are left: the prior keeps its own.
  Snapshot snapshot = problem.GetSnapshot();
  snapshot.first_estimate_vertices.clear();
  snapshot.first_estimates.clear();
  ASSERT_TRUE(problem.RestoreSnapshot(snapshot).ok());
  EXPECT_TRUE(problem.HasFirstEstimate(w.poses[1]));
  EXPECT_EQ(problem.RemoveVertex(w.poses[1]).code(), StatusCode::kUnderPrior);
}

TEST(LostPrior, CloneAfterTwoMarginalizationsWithoutASolveBetween) {
  Problem problem;
  ViWalk walk(1);
  walk.Attach(&problem);
  for (int k = 0; k < 8; ++k)
    walk.AddFrame();
  ASSERT_TRUE(problem.Solve({.max_iterations = 3}).ok());
  std::vector<AnyVertex> oldest;
  for (int turn = 0; turn < 3; ++turn) {
    walk.TakeOldest(&oldest);
    ASSERT_TRUE(problem.Marginalize(oldest).ok());
    Problem clone = problem.Clone();
    EXPECT_EQ(clone.Edges(), problem.Edges());
    EXPECT_EQ(Must(clone.Cost()), Must(problem.Cost()));
    const SolveSummary expected = problem.Clone().value().Solve({.max_iterations = 3});
    EXPECT_TRUE(SameIterations(clone.Solve({.max_iterations = 3}), expected));
  }
}

// A prior is a value: what is left of one that was moved from is a copy, not a null.
TEST(LostPrior, AMovedPriorLeavesNumbersBehind) {
  Problem problem;
  const Window w = AddWindow(&problem);
  const auto done = problem.Marginalize({w.poses[0]});
  ASSERT_TRUE(done.ok());
  EdgeMarginalPrior first = *FindMarginalPrior(problem, done->prior);
  const EdgeMarginalPrior second = std::move(first);
  EXPECT_EQ(first.ResidualDim(), second.ResidualDim());  // NOLINT: use after move
  EXPECT_EQ(first.TangentDim(), second.TangentDim());
}

/// An edge of a user's that cannot be copied.
class EdgeWithoutClone final : public DynamicEdge {
 public:
  [[nodiscard]] Status CheckVertices(std::span<const VertexOps* const>) const override {
    return {};
  }
  [[nodiscard]] int ResidualDim() const override { return 1; }
  bool Evaluate(std::span<const VertexRef> vertices, double* residual,
                double* const* jacobians) const override {
    residual[0] = vertices[0].data[0];
    if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = 1.0;
    return true;
  }
  [[nodiscard]] std::unique_ptr<DynamicEdge> Clone() const override { return nullptr; }
};

TEST(LostPrior, CloneOfAnEdgeThatReturnsNullIsAStatus) {
  Problem problem;
  const AnyVertex depth = problem.AddVertex(VertexInverseDepth{0.3}).value();
  const AnyVertex vertices[] = {depth};
  const auto edge = problem.AddEdge(std::make_unique<EdgeWithoutClone>(), vertices);
  ASSERT_TRUE(edge.ok());
  const Result<Problem> copy = problem.Clone();
  EXPECT_EQ(copy.status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(copy.status().edge(), AnyEdge(edge.value()));
  EXPECT_EQ(copy->NumVertices(), 0);
  EXPECT_TRUE(problem.Solve().converged()) << "the original is none the worse";
}

}  // namespace
}  // namespace glissade::test
