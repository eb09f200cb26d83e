// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/first_estimates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/pools.h"

namespace glissade {
namespace {

/// A prior r = J (x boxminus x0) with J = I on the given vertices at their present values.
Result<EdgeHandle<DynamicEdge>> AddPrior(Graph* graph, const std::vector<AnyVertex>& vertices) {
  std::vector<const VertexOps*> types;
  std::vector<double> x0;
  std::size_t dim = 0;
  for (const AnyVertex& vertex : vertices) {
    const VertexPoolBase* pool = graph->PoolOf(vertex.type);
    types.push_back(&pool->ops());
    const double* x = pool->Data(pool->slots().IndexOf(vertex.slot));
    x0.insert(x0.end(), x, x + pool->ops().ambient_dim);
    dim += static_cast<std::size_t>(pool->ops().tangent_dim);
  }
  std::vector<double> J(dim * dim, 0.0);
  for (std::size_t k = 0; k < dim; ++k)
    J[k * dim + k] = 1.0;
  auto edge = EdgeMarginalPrior::Create(types, x0, std::vector<double>(dim, 0.0), J);
  if (!edge.ok()) return edge.status();
  return graph->AddEdge(std::unique_ptr<DynamicEdge>(std::move(edge).value()), vertices);
}

class FirstEstimatesTest : public ::testing::Test {
 protected:
  VertexPose MakePose(double x) {
    VertexPose pose;
    pose.pose.data[0] = x;
    return pose;
  }
  void SetUp() override {
    for (int k = 0; k < 4; ++k)
      poses.push_back(graph.AddVertex(MakePose(k)).value());
    depth = graph.AddVertex(VertexInverseDepth{0.25}).value();
  }

  Graph graph;
  std::vector<VertexHandle<VertexPose>> poses;
  VertexHandle<VertexInverseDepth> depth;
};

TEST_F(FirstEstimatesTest, AVertexEntersWhenAPriorFirstTouchesIt) {
  EXPECT_FALSE(graph.HasFirstEstimate(poses[1]));
  EXPECT_EQ(graph.LinearizationPoint(poses[1])[0], 1.0);
  EXPECT_TRUE(graph.Pool<VertexPose>()->first_estimates().empty());
  ASSERT_TRUE(AddPrior(&graph, {poses[1], depth}).ok());
  ASSERT_TRUE(graph.Set(poses[1], MakePose(7.0)).ok());
  EXPECT_TRUE(graph.HasFirstEstimate(poses[1]));
  EXPECT_TRUE(graph.HasFirstEstimate(depth));
  EXPECT_FALSE(graph.HasFirstEstimate(poses[2]));
  EXPECT_EQ(graph.LinearizationPoint(poses[1])[0], 1.0);
  // A second prior does not move it.
  ASSERT_TRUE(AddPrior(&graph, {poses[1], poses[2]}).ok());
  EXPECT_EQ(graph.LinearizationPoint(poses[1])[0], 1.0);
  EXPECT_EQ(graph.LinearizationPoint(poses[2])[0], 2.0);
}

TEST_F(FirstEstimatesTest, ItLastsAsLongAsAPriorTouchesTheVertex) {
  const auto first = AddPrior(&graph, {poses[0], poses[1]});
  const auto second = AddPrior(&graph, {poses[1], poses[2]});
  ASSERT_TRUE(graph.RemoveEdge(first.value()).ok());
  EXPECT_FALSE(graph.HasFirstEstimate(poses[0]));
  EXPECT_TRUE(graph.HasFirstEstimate(poses[1]));
  // A prior goes with its vertices.
  ASSERT_TRUE(graph.RemoveVertex(poses[2], PriorOnVertex::kRemove).ok());
  EXPECT_FALSE(graph.Contains(AnyEdge(second.value())));
  EXPECT_FALSE(graph.HasFirstEstimate(poses[1]));
  EXPECT_TRUE(graph.Pool<VertexPose>()->first_estimates().empty());
}

TEST_F(FirstEstimatesTest, CompactionKeepsItWithItsVertex) {
  ASSERT_TRUE(AddPrior(&graph, {poses[3], poses[1]}).ok());
  ASSERT_TRUE(graph.RemoveVertex(poses[0]).ok());
  graph.Compact();
  const auto added = graph.AddVertex(MakePose(11.0));
  ASSERT_TRUE(graph.Set(poses[1], MakePose(-1.0)).ok());
  ASSERT_TRUE(graph.Set(poses[3], MakePose(-3.0)).ok());
  EXPECT_EQ(graph.LinearizationPoint(poses[1])[0], 1.0);
  EXPECT_EQ(graph.LinearizationPoint(poses[3])[0], 3.0);
  EXPECT_FALSE(graph.HasFirstEstimate(poses[2]));
  EXPECT_FALSE(graph.HasFirstEstimate(added.value()));
  EXPECT_TRUE(graph.LinearizationPoint(poses[0]).empty());
}

TEST_F(FirstEstimatesTest, CopiesCarryIt) {
  ASSERT_TRUE(AddPrior(&graph, {poses[1]}).ok());
  graph.SetFirstEstimates(FirstEstimates::kFull);
  ASSERT_TRUE(graph.Set(poses[1], MakePose(5.0)).ok());
  const Graph copy = graph.Clone();
  EXPECT_EQ(copy.first_estimates(), FirstEstimates::kFull);
  EXPECT_EQ(copy.LinearizationPoint(poses[1])[0], 1.0);

  const Snapshot snapshot = graph.GetSnapshot();
  const double other[7] = {9, 0, 0, 0, 0, 0, 1};
  ASSERT_TRUE(graph.SetFirstEstimate(poses[1], other).ok());
  ASSERT_TRUE(graph.SetFirstEstimate(poses[2], other).ok());
  EXPECT_EQ(graph.LinearizationPoint(poses[1])[0], 9.0);
  ASSERT_TRUE(graph.RestoreSnapshot(snapshot).ok());
  EXPECT_EQ(graph.LinearizationPoint(poses[1])[0], 1.0);
  EXPECT_FALSE(graph.HasFirstEstimate(poses[2]));
}

TEST_F(FirstEstimatesTest, Refusals) {
  const double x[7] = {0, 0, 0, 0, 0, 0, NAN};
  EXPECT_EQ(graph.SetFirstEstimate(poses[0], x).code(), StatusCode::kNotFinite);
  EXPECT_EQ(graph.SetFirstEstimate(poses[0], std::span(x, 6)).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(graph.SetFirstEstimate(AnyVertex(), x).code(), StatusCode::kUnknownHandle);
  EXPECT_FALSE(graph.HasFirstEstimate(poses[0]));
  Snapshot snapshot = graph.GetSnapshot();
  snapshot.first_estimate_vertices.push_back(poses[0]);
  EXPECT_EQ(graph.RestoreSnapshot(snapshot).code(), StatusCode::kInvalidArgument);
}

// Any value was taken, and then was neither of the three.
TEST_F(FirstEstimatesTest, AModeThatIsNoneIsRefusedByName) {
  ASSERT_TRUE(graph.SetFirstEstimates(FirstEstimates::kPriorOnly).ok());
  const std::uint64_t version = graph.structure_version();
  const Status status = graph.SetFirstEstimates(static_cast<FirstEstimates>(7));
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(status.message(), "SetFirstEstimates: 7 is no FirstEstimates");
  EXPECT_EQ(graph.first_estimates(), FirstEstimates::kPriorOnly);
  EXPECT_EQ(graph.structure_version(), version);
  EXPECT_EQ(graph.first_refusal().message(), status.message());
}

TEST(FirstEstimateSize, WhatMovesUnderTheGauge) {
  EXPECT_EQ(kVertexOps<VertexPose>.first_estimate_size, 7);
  EXPECT_EQ(kVertexOps<VertexPointXYZ>.first_estimate_size, 3);
  EXPECT_EQ(kVertexOps<VertexSpeedBias>.first_estimate_size, 3);
  EXPECT_EQ(kVertexOps<VertexInverseDepth>.first_estimate_size, 0);
}

}  // namespace
}  // namespace glissade
