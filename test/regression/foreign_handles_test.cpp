// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Handles of another graph were accepted wherever slot and generation agreed: Set() wrote into a
// vertex of a stranger, RemoveVertex() removed one.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

using Call = std::pair<std::string, std::function<Status(Problem&)>>;

SolveOptions WithGauge(const Gauge& gauge) {
  SolveOptions options;
  options.gauge = gauge;
  return options;
}

/// Every call that takes a handle, each with one from `w`.
std::vector<Call> CallsWithHandlesOf(const Window& w) {
  const auto pose = w.poses[3];
  const auto depth = w.landmarks[2];
  const auto edge = w.edges[1];
  const auto prior = w.priors[0];
  const std::vector<AnyVertex> both{pose};
  const SquareMatrix<2> identity = SquareMatrix<2>::Identity();
  return {
      {"Set", [=](Problem& p) { return p.Set(depth, VertexInverseDepth{0.5}); }},
      {"RemoveVertex", [=](Problem& p) { return p.RemoveVertex(pose); }},
      {"RemoveEdge", [=](Problem& p) { return p.RemoveEdge(edge); }},
      {"SetFixed", [=](Problem& p) { return p.SetFixed(pose, Fix::kPosition); }},
      {"SetEliminated", [=](Problem& p) { return p.SetEliminated(depth, false); }},
      {"SetLoss", [=](Problem& p) { return p.SetLoss(edge, Huber{1.0}); }},
      {"SetInformation", [=](Problem& p) { return p.SetInformation(edge, identity); }},
      {"SetSqrtInformation", [=](Problem& p) { return p.SetSqrtInformation(edge, identity); }},
      {"SetFirstEstimate",
       [=](Problem& p) {
         const double x[] = {0, 0, 0, 0, 0, 0, 1};
         return p.SetFirstEstimate(pose, x);
       }},
      {"AddEdge", [=](Problem& p) { return p.AddEdge(EdgeSE3Prior(), {pose}).status(); }},
      {"AddEdges",
       [=](Problem& p) {
         // The second one takes the quick way.
         const auto own = p.AddVertex(VertexPose()).value();
         const std::vector<EdgeSE3Prior> edges(2);
         const std::vector<EdgeVertexHandles<EdgeSE3Prior>> on{{own}, {pose}};
         const Status status = p.AddEdges(std::span(edges), std::span(on)).status();
         EXPECT_TRUE(p.RemoveVertex(own).ok());
         return status;
       }},
      {"VerticesOf", [=](Problem& p) { return p.VerticesOf(edge).status(); }},
      {"EdgesOf", [=](Problem& p) { return p.EdgesOf(pose).status(); }},
      {"Chi2", [=](Problem& p) { return p.Chi2(prior).status(); }},
      {"DepthOf", [=](Problem& p) { return p.DepthOf(edge).status(); }},
      {"Marginalize", [=](Problem& p) { return p.Marginalize(both).status(); }},
      {"Marginalize, drop",
       [=](Problem& p) {
         const AnyEdge drop[] = {edge};
         return p.Marginalize({p.Vertices()[0]}, {.drop = drop}).status();
       }},
      {"ComputeMarginalPrior", [=](Problem& p) { return p.ComputeMarginalPrior(both).status(); }},
      {"ComputeCovariance", [=](Problem& p) { return p.ComputeCovariance(both).status(); }},
      {"Gauge::Fixed", [=](Problem& p) { return p.Solve(WithGauge(Gauge::Fixed{pose})).status; }},
      {"Gauge::Prior",
       [=](Problem& p) {
         return p.Solve(WithGauge(Gauge::Prior{pose, 1e3})).status;
       }},
      {"Gauge::FixedPoses",
       [=](Problem& p) {
         return p.Solve(WithGauge(Gauge::FixedPoses{pose, w.poses[0]})).status;
       }},
      {"MoveToGauge", [=](Problem& p) { return p.MoveToGauge(Gauge::Fixed{pose}); }},
  };
}

TEST(ForeignHandles, AreRefusedByEveryCallThatTakesOne) {
  Problem mine, other;
  AddWindow(&mine);
  const Window foreign = AddWindow(&other);  // the same slots and generations
  const GraphRecord before(mine);
  for (const auto& [name, call] : CallsWithHandlesOf(foreign)) {
    SCOPED_TRACE(name);
    const Status status = call(mine);
    EXPECT_EQ(status.code(), StatusCode::kUnknownHandle) << status.message();
    EXPECT_TRUE(status.vertex() || status.edge()) << "names the culprit";
    EXPECT_NE(status.message().find("of another"), std::string::npos) << status.message();
    mine.AcknowledgeRefusal();
    const GraphRecord after(mine);
    EXPECT_TRUE(SameBits(before.snapshot, after.snapshot));
    EXPECT_EQ(before.edges, after.edges);
    EXPECT_EQ(before.cost, after.cost);
  }
  EXPECT_EQ(mine.Find(foreign.poses[0]), nullptr);
  EXPECT_EQ(mine.Find(foreign.edges[0]), nullptr);
  EXPECT_FALSE(mine.Contains(AnyVertex(foreign.poses[0])));
  EXPECT_FALSE(mine.HasFirstEstimate(foreign.poses[0]));
  EXPECT_TRUE(mine.LinearizationPoint(foreign.poses[0]).empty());
  EXPECT_EQ(mine.RestoreSnapshot(other.GetSnapshot()).code(), StatusCode::kInvalidArgument);
}

TEST(ForeignHandles, ACloneTakesThoseOfItsOriginal) {
  Problem original;
  const Window w = AddWindow(&original);
  for (const auto& [name, call] : CallsWithHandlesOf(w)) {
    SCOPED_TRACE(name);
    Problem clone = original.Clone();
    Problem grandchild = clone.Clone();
    const Status direct = call(clone), far = call(grandchild);
    EXPECT_NE(direct.code(), StatusCode::kUnknownHandle) << direct.message();
    EXPECT_NE(far.code(), StatusCode::kUnknownHandle) << far.message();
  }
  Problem clone = original.Clone();
  EXPECT_EQ(clone.Vertices(), original.Vertices()) << "one handle, whoever is asked";
  EXPECT_EQ(clone.Edges(), original.Edges());
  const Problem moved = std::move(original);
  EXPECT_NE(moved.Find(w.poses[0]), nullptr) << "a moved graph keeps its handles";
  // NOLINTNEXTLINE: what is left behind is to be of use.
  EXPECT_EQ(original.Find(w.poses[0]), nullptr);
}

// After a clone both have the same free slots and give out the same numbers.
TEST(ForeignHandles, OfWhatCameAfterTheCloneAreRefusedByTheOther) {
  Graph original;
  const Window w = AddWindow(&original);
  Must(original.RemoveVertex(w.poses[4]));
  Graph clone = original.Clone();
  const auto in_original = original.AddVertex(VertexPose()).value();
  const auto in_clone = clone.AddVertex(VertexPose()).value();
  ASSERT_EQ(in_original.slot, in_clone.slot) << "the test wants a coincidence";
  ASSERT_EQ(in_original.generation, in_clone.generation);
  EXPECT_NE(in_original, in_clone);
  EXPECT_NE(original.Find(in_original), nullptr);
  EXPECT_NE(clone.Find(in_clone), nullptr);
  EXPECT_EQ(original.Find(in_clone), nullptr);
  EXPECT_EQ(clone.Find(in_original), nullptr);
  const auto edge_in_original = original.AddEdge(EdgeSE3Prior(), {w.poses[0]}).value();
  const auto edge_in_clone = clone.AddEdge(EdgeSE3Prior(), {w.poses[0]}).value();
  ASSERT_EQ(edge_in_original.slot, edge_in_clone.slot);
  EXPECT_EQ(clone.RemoveEdge(edge_in_original).code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(original.RemoveEdge(edge_in_clone).code(), StatusCode::kUnknownHandle);

  // What was there before is known to both until either removes it, and dies there alone.
  Must(original.RemoveVertex(w.poses[0]));
  EXPECT_NE(clone.Find(w.poses[0]), nullptr);
  const auto again = original.AddVertex(VertexPose()).value();
  ASSERT_EQ(again.slot, w.poses[0].slot);
  Must(clone.RemoveVertex(w.poses[0]));
  const auto again_in_clone = clone.AddVertex(VertexPose()).value();
  ASSERT_EQ(again.generation, again_in_clone.generation);
  EXPECT_EQ(clone.Find(again), nullptr);
  EXPECT_EQ(original.Find(again_in_clone), nullptr);
  EXPECT_EQ(clone.RestoreSnapshot(original.GetSnapshot()).code(), StatusCode::kInvalidArgument);
}

TEST(ForeignHandles, HandlesHashCompareAndTellTheirType) {
  Graph a, b;
  std::unordered_set<AnyVertex> vertices;
  std::unordered_set<VertexHandle<VertexPose>> poses;
  std::unordered_set<EdgeHandle<EdgeSE3Prior>> priors;
  std::unordered_map<AnyEdge, int> edges;
  for (Graph* graph : {&a, &b}) {
    for (int k = 0; k < 200; ++k) {
      const auto pose = graph->AddVertex(VertexPose()).value();
      const auto depth = graph->AddVertex(VertexInverseDepth{0.1}).value();
      const auto prior = graph->AddEdge(EdgeSE3Prior(), {pose}).value();
      vertices.insert(pose);
      vertices.insert(depth);
      poses.insert(pose);
      priors.insert(prior);
      ++edges[prior];
      EXPECT_EQ(AnyVertex(pose).As<VertexPose>(), pose);
      EXPECT_EQ(AnyVertex(pose).As<VertexInverseDepth>(), std::nullopt);
      EXPECT_EQ(AnyEdge(prior).As<EdgeSE3Prior>(), prior);
      EXPECT_EQ(AnyEdge(prior).As<EdgeReprojection>(), std::nullopt);
    }
  }
  EXPECT_EQ(AnyVertex().As<VertexPose>(), std::nullopt);
  EXPECT_EQ(vertices.size(), 800u);
  EXPECT_EQ(poses.size(), 400u);
  EXPECT_EQ(priors.size(), 400u);
  EXPECT_EQ(edges.size(), 400u);
}

}  // namespace
}  // namespace glissade::test
