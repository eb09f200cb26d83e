// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/marginal/marginalize.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "glissade/graph/pools.h"
#include "glissade/marginal/drift.h"
#include "marginal/linear_graph.h"
#include "support/dense_reference.h"
#include "support/random_graph.h"
#include "support/vi_walk.h"

namespace glissade {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using VectorXl = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

bool IsIn(const std::vector<AnyVertex>& list, AnyVertex vertex) {
  return std::find(list.begin(), list.end(), vertex) != list.end();
}

/// H* and b* of what is left, from a dense Jacobian of the folded edges at x and a pseudo-inverse
/// in long double.
struct Reference {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;

  Reference(const Graph& original, const std::vector<AnyVertex>& out,
            const std::vector<AnyVertex>& left) {
    Graph graph = original.Clone();
    for (const AnyEdge& edge : graph.Edges()) {
      const auto vertices = graph.VerticesOf(edge).value();
      if (std::none_of(vertices.begin(), vertices.end(),
                       [&](AnyVertex v) { return IsIn(out, v); })) {
        EXPECT_TRUE(graph.RemoveEdge(edge).ok());
      }
    }
    for (const AnyVertex& vertex : left)
      EXPECT_TRUE(graph.SetFixed(vertex, Fix::kFree).ok());
    std::vector<AnyVertex> order = out;
    order.insert(order.end(), left.begin(), left.end());
    Eigen::Index n = 0;
    for (const AnyVertex& vertex : left)
      n += graph.PoolOf(vertex.type)->ops().tangent_dim;
    const test::DenseReference dense(graph, order);
    const MatrixXl J = dense.J.cast<long double>();
    const MatrixXl full = J.transpose() * J;
    const VectorXl g = J.transpose() * dense.r.cast<long double>();
    const Eigen::Index m = full.rows() - n;
    // Scaled to a unit diagonal, eigenvalues under 1e-15 of the largest cut.
    VectorXl scale = full.topLeftCorner(m, m).diagonal();
    for (Eigen::Index i = 0; i < m; ++i)
      scale[i] = scale[i] > 0 ? 1 / std::sqrt(scale[i]) : 0;
    const MatrixXl scaled = scale.asDiagonal() * full.topLeftCorner(m, m) * scale.asDiagonal();
    if (m == 0) {  // what goes is all fixed
      H = full.cast<double>();
      b = -g.cast<double>();
      return;
    }
    const Eigen::SelfAdjointEigenSolver<MatrixXl> eigen(scaled);
    VectorXl inverse = VectorXl::Zero(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const long double lambda = eigen.eigenvalues()[i];
      if (lambda > 1e-15L * eigen.eigenvalues()[m - 1]) inverse[i] = 1 / lambda;
    }
    const MatrixXl W = full.bottomLeftCorner(n, m) * scale.asDiagonal() * eigen.eigenvectors();
    H = (full.bottomRightCorner(n, n) - W * inverse.asDiagonal() * W.transpose()).cast<double>();
    b = -(g.tail(n) - W * inverse.asDiagonal() *
                          (eigen.eigenvectors().transpose() * (scale.asDiagonal() * g.head(m))))
             .cast<double>();
  }
};

Eigen::MatrixXd InformationOf(const MarginalPrior& prior) {
  const Eigen::Map<const RowMajor> J(prior.jacobian.data(), prior.rows(), prior.tangent_dim);
  return J.transpose() * J;
}

/// -J'r at the prior's own origin moved by x boxminus x0 of the graph.
Eigen::VectorXd RhsOf(const MarginalPrior& prior, const Graph& graph) {
  const Eigen::Map<const RowMajor> J(prior.jacobian.data(), prior.rows(), prior.tangent_dim);
  Eigen::VectorXd dx(prior.tangent_dim);
  const double* x0 = prior.x0.data();
  double* delta = dx.data();
  for (const AnyVertex& vertex : prior.vertices) {
    const VertexPoolBase& pool = *graph.PoolOf(vertex.type);
    pool.ops().minus(pool.Data(pool.slots().IndexOf(vertex.slot)), x0, delta);
    x0 += pool.ops().ambient_dim;
    delta += pool.ops().tangent_dim;
  }
  return -(J.transpose() *
           (Eigen::Map<const Eigen::VectorXd>(prior.r0.data(), prior.rows()) + J * dx));
}

std::vector<MarginalizeOptions> AllForms() {
  std::vector<MarginalizeOptions> forms(3);
  forms[1].form = forms[2].form = MarginalForm::kSchur;
  forms[2].root = InformationRoot::kEigen;
  return forms;
}

class OnRandomGraphs : public ::testing::TestWithParam<test::GraphKind> {};

TEST_P(OnRandomGraphs, InformationAndRhsAreThoseOfADenseReference) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Graph graph = test::MakeRandomGraph(GetParam(), seed, {.num_landmarks = 12});
    test::Random random(seed);
    std::vector<AnyVertex> out;
    for (const AnyVertex& vertex : graph.Vertices()) {
      if (out.empty() || random.Uniform(0, 1) < 0.3) out.push_back(vertex);
    }
    const double cost = graph.Cost().value();
    for (const MarginalizeOptions& options : AllForms()) {
      const auto prior = ComputeMarginalPrior(graph, out, options);
      ASSERT_TRUE(prior.ok()) << prior.status().message();
      const Reference reference(graph, out, prior->vertices);
      EXPECT_LT(test::HessianError(InformationOf(*prior), reference.H), 1e-9)
          << ToString(GetParam()) << " seed " << seed;
      EXPECT_LT((RhsOf(*prior, graph) - reference.b).norm(), 1e-9 * (1 + reference.b.norm()))
          << ToString(GetParam()) << " seed " << seed;
      for (const AnyVertex& vertex : prior->vertices)
        EXPECT_FALSE(IsIn(out, vertex));
    }
    EXPECT_EQ(graph.Cost().value(), cost);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, OnRandomGraphs, ::testing::ValuesIn(test::kAllGraphKinds));

/// Under kOff an older prior is moved to x and all is linearized there: what the dense reference
/// does with the exact derivative of the prior.
TEST(Marginalize, AnOlderPriorIsFoldedInAtThePresentValues) {
  for (const MarginalizeOptions& options : AllForms()) {
    test::ViWalk walk(5);
    walk.graph().SetFirstEstimates(FirstEstimates::kOff);
    for (int k = 0; k < 8; ++k)
      walk.AddFrame();
    const auto done = Marginalize(&walk.graph(), walk.TakeOldest(), options);
    ASSERT_TRUE(done.ok()) << done.status().message();
    EXPECT_EQ(done->report.eliminated_landmarks, 6);
    walk.Shake(0.03, 1.0);
    const auto out = walk.TakeOldest();
    const auto prior = ComputeMarginalPrior(walk.graph(), out, options);
    ASSERT_TRUE(prior.ok());
    EXPECT_EQ(prior->report.folded_priors, 1);
    const Reference reference(walk.graph(), out, prior->vertices);
    EXPECT_LT(test::HessianError(InformationOf(*prior), reference.H), 1e-9);
    EXPECT_LT((RhsOf(*prior, walk.graph()) - reference.b).norm(), 1e-8 * reference.b.norm());
  }
}

/// With first estimates x0 stays, the prior's J is constant, and what is folded in has its value
/// at x: the rhs at x is -J_lin' r(x), marginalized.
TEST(Marginalize, WithFirstEstimatesValuesAreExactAtThePresentState) {
  for (const FirstEstimates mode : {FirstEstimates::kPriorOnly, FirstEstimates::kFull}) {
    test::ViWalk walk(6);
    walk.graph().SetFirstEstimates(mode);
    for (int k = 0; k < 8; ++k)
      walk.AddFrame();
    ASSERT_TRUE(Marginalize(&walk.graph(), walk.TakeOldest()).ok());
    const std::vector<double> first(walk.graph().LinearizationPoint(walk.pose(1)).begin(),
                                    walk.graph().LinearizationPoint(walk.pose(1)).end());
    walk.Shake(0.02, 0.5);
    EXPECT_NE(first[0], walk.graph().Get(walk.pose(1)).Data()[0]);
    const auto out = walk.TakeOldest();
    const auto a = ComputeMarginalPrior(walk.graph(), out);
    const auto c = ComputeMarginalPrior(walk.graph(), out, {.form = MarginalForm::kSchur});
    ASSERT_TRUE(a.ok() && c.ok());
    EXPECT_EQ(a->vertices, c->vertices);
    EXPECT_LT(test::HessianError(InformationOf(*c), InformationOf(*a)), 1e-9);
    EXPECT_LT((RhsOf(*c, walk.graph()) - RhsOf(*a, walk.graph())).norm(),
              1e-8 * RhsOf(*a, walk.graph()).norm());
    // x0 is x_lin where there was one, and stays so in the graph.
    EXPECT_EQ(std::vector<double>(a->x0.begin(), a->x0.begin() + 7), first);
    const auto done = Marginalize(&walk.graph(), out);
    ASSERT_TRUE(done.ok());
    EXPECT_EQ(walk.graph().LinearizationPoint(walk.pose(0))[0], first[0]);
    // Moving every state back to x_lin and linearizing there gives the same information.
    const auto drift = Drift(walk.graph(), *done);
    ASSERT_TRUE(drift.ok());
    EXPECT_EQ(drift->front().vertex, AnyVertex(walk.pose(0)));
    double moved = 0.0;
    for (const double d : drift->front().delta)
      moved = std::max(moved, std::abs(d));
    EXPECT_GT(moved, 1e-3);
    EXPECT_LT(moved, 0.1);
  }
}

TEST(Marginalize, LandmarksOfOnePriorAreKept) {
  test::ViWalk walk(8);
  for (int k = 0; k < 5; ++k)
    walk.AddFrame();
  const auto oldest = walk.TakeOldest();
  // Its landmarks stay: they come under the prior, all of them.
  const auto done = Marginalize(&walk.graph(), std::span(oldest).first(2));
  ASSERT_TRUE(done.ok()) << done.status().message();
  EXPECT_EQ(done->report.eliminated_landmarks, 0);
  Graph& graph = walk.graph();
  for (std::size_t k = 2; k < oldest.size(); ++k) {
    const VertexPoolBase* pool = graph.PoolOf(oldest[k].type);
    EXPECT_FALSE(pool->eliminated(pool->slots().IndexOf(oldest[k].slot)));
    EXPECT_TRUE(graph.HasFirstEstimate(oldest[k]));
  }
  // And can go later.
  const auto rest = Marginalize(&graph, std::span(oldest).subspan(2));
  ASSERT_TRUE(rest.ok());
  EXPECT_FALSE(graph.Contains(AnyEdge(done->prior)));
}

TEST(Marginalize, DroppedEdgesLeaveNothing) {
  test::ViWalk walk(9);
  for (int k = 0; k < 6; ++k)
    walk.AddFrame();
  const auto out = walk.TakeOldest();
  std::vector<AnyEdge> reprojections;
  for (const AnyEdge& edge : walk.graph().Edges()) {
    if (edge.type == &kTypeInfo<EdgeReprojection>) reprojections.push_back(edge);
  }
  const auto by_list = ComputeMarginalPrior(walk.graph(), out, {.drop = reprojections});
  const auto by_rule =
      ComputeMarginalPrior(walk.graph(), out, {.drop_if = [](const Graph&, AnyEdge edge) {
                             return edge.type == &kTypeInfo<EdgeReprojection>;
                           }});
  ASSERT_TRUE(by_list.ok() && by_rule.ok());
  EXPECT_EQ(by_list->jacobian, by_rule->jacobian);
  EXPECT_EQ(by_list->report.dropped_edges, 24);
  EXPECT_EQ(by_list->report.folded_edges, 1);  // the IMU's
  EXPECT_EQ(by_list->vertices.size(), 2u);
  // The landmarks had nothing left.
  EXPECT_GE(by_list->report.rank_deficiency, 6);
}

TEST(Marginalize, WhatHasNoInformationIsReportedAndTakesNothing) {
  // A point that is seen once: two of its three coordinates.
  Graph graph;
  VertexPose at;
  const auto first = graph.AddVertex(at), second = graph.AddVertex(at);
  const auto seen_once = graph.AddVertex(VertexPointXYZ(0.3, 0.2, 4.0));
  const auto seen_twice = graph.AddVertex(VertexPointXYZ(-0.3, 0.2, 4.0));
  VertexPose moved;
  moved.pose.data[0] = 0.5;
  ASSERT_TRUE(graph.Set(second, moved).ok());
  const auto see = [&](auto pose, auto point) {
    ASSERT_TRUE(graph.AddEdge(EdgeReprojectionXYZ{}, {pose, point}).ok());
  };
  see(first, seen_once);
  see(first, seen_twice);
  see(second, seen_twice);
  for (const MarginalizeOptions& options : AllForms()) {
    const std::vector<AnyVertex> out{seen_once.value(), seen_twice.value()};
    const auto prior = ComputeMarginalPrior(graph, out, options);
    ASSERT_TRUE(prior.ok());
    EXPECT_EQ(prior->report.rank_deficiency, 1);
    ASSERT_EQ(prior->report.deficient.size(), 1u);
    EXPECT_EQ(prior->report.deficient[0], AnyVertex(seen_once.value()));
    const Reference reference(graph, out, prior->vertices);
    EXPECT_LT((InformationOf(*prior) - reference.H).norm(), 1e-10 * reference.H.norm());
  }
  // A pose that goes with nothing but a point seen from it once and a relative pose.
  ASSERT_TRUE(graph.AddEdge(EdgeRelativePose{}, {first, second}).ok());
  for (const MarginalizeOptions& options : AllForms()) {
    const std::vector<AnyVertex> all{first.value(), second.value(), seen_once.value()};
    const auto prior = ComputeMarginalPrior(graph, all, options);
    ASSERT_TRUE(prior.ok());
    EXPECT_GE(prior->report.rank_deficiency, 1);
    EXPECT_FALSE(prior->report.deficient.empty());
    const Reference reference(graph, all, prior->vertices);
    EXPECT_LT((InformationOf(*prior) - reference.H).norm(), 1e-9 * (1.0 + reference.H.norm()));
  }
}

TEST(Marginalize, RefusesAndLeavesTheGraphAsItWas) {
  test::ViWalk walk(10);
  for (int k = 0; k < 4; ++k)
    walk.AddFrame();
  Graph& graph = walk.graph();
  const int vertices = graph.NumVertices(), edges = graph.NumEdges();
  const std::uint64_t version = graph.structure_version();
  const auto refuse = [&](const std::vector<AnyVertex>& out, const MarginalizeOptions& options) {
    const Status status = Marginalize(&graph, out, options).status();
    EXPECT_EQ(graph.NumVertices(), vertices);
    EXPECT_EQ(graph.NumEdges(), edges);
    EXPECT_EQ(graph.structure_version(), version);
    return status;
  };
  const AnyVertex pose = walk.pose(0);
  EXPECT_EQ(refuse({AnyVertex()}, {}).code(), StatusCode::kUnknownHandle);
  const Status repeated = refuse({pose, walk.pose(1), pose}, {});
  EXPECT_EQ(repeated.code(), StatusCode::kRepeatedVertex);
  EXPECT_EQ(repeated.vertex(), pose);
  const std::vector<AnyEdge> dead{AnyEdge()};
  EXPECT_EQ(refuse({pose}, {.drop = dead}).code(), StatusCode::kUnknownHandle);
  // An edge without a value: a point in the plane of the camera.
  Graph other;
  const auto camera = other.AddVertex(VertexPose{});
  const auto point = other.AddVertex(VertexPointXYZ(1.0, 0.0, 0.0));
  const auto edge = other.AddEdge(EdgeReprojectionXYZ{}, {camera, point});
  ASSERT_TRUE(edge.ok());
  const Status failed = Marginalize(&other, std::vector<AnyVertex>{point.value()}).status();
  EXPECT_EQ(failed.code(), StatusCode::kEvaluationFailed) << failed.message();
  EXPECT_EQ(failed.edge(), AnyEdge(edge.value()));
  EXPECT_TRUE(other.Contains(AnyEdge(edge.value())));
}

TEST(Marginalize, NothingConnectedLeavesNoPrior) {
  Graph graph;
  const auto pose = graph.AddVertex(VertexPose{});
  ASSERT_TRUE(graph.AddEdge(EdgeSE3Prior{}, {pose}).ok());
  const auto done = Marginalize(&graph, std::vector<AnyVertex>{pose.value()});
  ASSERT_TRUE(done.ok());
  EXPECT_EQ(done->prior.slot, kNullSlot);
  EXPECT_EQ(graph.NumVertices(), 0);
}

}  // namespace
}  // namespace glissade
