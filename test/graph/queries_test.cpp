// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Chi2, Cost, DepthOf, GetOutlierEdges, and what is reported where an edge has no value.

#include <gtest/gtest.h>

#include <cmath>

#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

/// Two cameras one metre apart in z, both looking along z, and one landmark straight ahead.
class GraphQueries : public ::testing::Test {
 protected:
  GraphQueries() {
    host_ = graph_.AddVertex(VertexPose());
    target_ = graph_.AddVertex(VertexPose{Pose(Quaternion::Identity(), Vector3(0.0, 0.0, 1.0))});
    depth_ = graph_.AddVertex(VertexInverseDepth{0.25});
    EdgeOptions<EdgeReprojection> weight;
    weight.sqrt_information = 100.0 * Matrix2::Identity();
    EdgeReprojection edge;
    edge.uv_target = Vector2(0.02, 0.0);  // predicted (0, 0): 2 sigmas off
    edge_ = graph_.AddEdge(edge, {host_, target_, depth_}, weight);
  }
  void SetRho(double rho) { Must(graph_.Set(depth_, VertexInverseDepth{rho})); }

  Graph graph_;
  VertexHandle<VertexPose> host_, target_;
  VertexHandle<VertexInverseDepth> depth_;
  EdgeHandle<EdgeReprojection> edge_;
};

TEST_F(GraphQueries, Chi2IsInSquaredSigmasCostIsHalfOfItUnderTheLoss) {
  EXPECT_NEAR(Must(graph_.Chi2(AnyEdge(edge_))), 4.0, 1e-12);
  EXPECT_NEAR(Must(graph_.Chi2()), 4.0, 1e-12);
  EXPECT_NEAR(Must(graph_.Cost()), 2.0, 1e-12);
  Must(graph_.SetLoss(edge_, Huber{1.0}));  // rho(4) = 2 * 2 - 1
  EXPECT_NEAR(Must(graph_.Chi2()), 4.0, 1e-12);
  EXPECT_NEAR(Must(graph_.Cost()), 1.5, 1e-12);
  EXPECT_EQ(Must(Graph().Chi2()), 0.0);
  EXPECT_EQ(Must(Graph().Cost()), 0.0);
}

TEST_F(GraphQueries, TheCostOfTheGraphIsTheCostThatSolveStartsFrom) {
  Problem problem;
  const Window w = AddWindow(&problem, {.frames = 5, .landmarks = 30, .loss = Huber{1.0}});
  Must(problem.SetFixed(w.poses[0]));
  Must(problem.SetFixed(w.landmarks[3]));
  const double cost = Must(problem.Cost());
  EXPECT_NEAR(problem.Solve().initial_cost, cost, 1e-12 * cost);
}

TEST_F(GraphQueries, DepthIsThatInTheObservingCamera) {
  EXPECT_NEAR(Must(graph_.DepthOf(AnyEdge(edge_))), 3.0, 1e-12);
  SetRho(2.0);  // at 0.5 m of the host: behind the target
  EXPECT_NEAR(Must(graph_.DepthOf(AnyEdge(edge_))), -0.5, 1e-12);
  SetRho(-0.5);  // behind both
  EXPECT_LT(Must(graph_.DepthOf(AnyEdge(edge_))), 0.0);
  const auto prior = Must(graph_.AddEdge(EdgeSE3Prior(), {host_}));
  const Status none = graph_.DepthOf(AnyEdge(prior)).status();
  EXPECT_EQ(none.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(none.edge(), AnyEdge(prior));
}

TEST_F(GraphQueries, OutliersAreFarOffOrBehindOrWithoutAValue) {
  EXPECT_TRUE(graph_.GetOutlierEdges().empty());
  EXPECT_EQ(graph_.GetOutlierEdges({.max_chi2 = 3.9}), std::vector<AnyEdge>{AnyEdge(edge_)});
  EXPECT_TRUE(graph_.GetOutlierEdges({.max_chi2 = 4.1}).empty());
  EXPECT_EQ(graph_.GetOutlierEdges({.min_depth = 3.1}).size(), 1u);
  SetRho(2.0);
  EXPECT_EQ(graph_.GetOutlierEdges().size(), 1u) << "behind the target";
  SetRho(1.0);
  EXPECT_EQ(graph_.GetOutlierEdges().size(), 1u) << "in the target's centre: no value";
  // Priors are no observations, however far off.
  Must(
      graph_.AddEdge(EdgeSE3Prior{Pose(Quaternion::Identity(), Vector3(50.0, 0.0, 0.0))}, {host_}));
  SetRho(0.25);
  EXPECT_TRUE(graph_.GetOutlierEdges().empty());
  // Nor are removed ones.
  SetRho(2.0);
  Must(graph_.RemoveEdge(edge_));
  EXPECT_TRUE(graph_.GetOutlierEdges().empty());
}

TEST_F(GraphQueries, OutliersComeInInsertionOrder) {
  Graph graph;
  const Window w = AddWindow(&graph, {.frames = 5, .landmarks = 40});
  Must(graph.RemoveEdge(w.edges[0]));
  std::vector<AnyEdge> expected;
  for (const AnyEdge& edge : graph.Edges()) {
    if (edge.type == &kTypeInfo<EdgeReprojection> && Must(graph.Chi2(edge)) > 50.0) {
      expected.push_back(edge);
    }
  }
  ASSERT_GT(expected.size(), 5u);
  EXPECT_EQ(graph.GetOutlierEdges({.max_chi2 = 50.0, .min_depth = -1e9}), expected);
}

TEST_F(GraphQueries, AnEdgeWithoutAValueIsNamedNotSkipped) {
  SetRho(1.0);  // z = 0 in the target
  for (const Status& status :
       {graph_.Chi2(AnyEdge(edge_)).status(), graph_.Chi2().status(), graph_.Cost().status()}) {
    EXPECT_EQ(status.code(), StatusCode::kEvaluationFailed);
    EXPECT_EQ(status.edge(), AnyEdge(edge_));
    EXPECT_NE(status.message().find(ToString(edge_)), std::string::npos);
  }
}

TEST_F(GraphQueries, NeighboursAreFoundBothWays) {
  EXPECT_EQ(Must(graph_.VerticesOf(edge_)), (std::vector<AnyVertex>{host_, target_, depth_}));
  const auto prior = Must(graph_.AddEdge(EdgeSE3Prior(), {target_}));
  EXPECT_EQ(Must(graph_.EdgesOf(target_)), (std::vector<AnyEdge>{edge_, prior}));
  EXPECT_EQ(Must(graph_.EdgesOf(host_)), std::vector<AnyEdge>{AnyEdge(edge_)});
  Must(graph_.RemoveEdge(edge_));
  EXPECT_TRUE(Must(graph_.EdgesOf(host_)).empty());
  EXPECT_EQ(graph_.NumEdges<EdgeReprojection>(), 0);
  EXPECT_EQ(graph_.NumEdges<EdgeSE3Prior>(), 1);
  EXPECT_EQ(graph_.NumVertices<VertexPose>(), 2);
  EXPECT_EQ(graph_.NumVertices<VertexPointXYZ>(), 0) << "a type the graph has never seen";
}

}  // namespace
}  // namespace glissade::test
