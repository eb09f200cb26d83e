// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// States from outside that were believed: a snapshot with a chart of 50 free dimensions crashed the
// next solve, and zero quaternions and vertices given twice were taken by RestoreSnapshot(),
// SetFirstEstimate() and marginal priors. And questions to what is not there: the Uninformed() of a
// Covariance that was moved from crashed, neighbours of dead handles were empty lists.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/pools.h"
#include "glissade/problem/problem.h"
#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class UntrustedSnapshot : public ::testing::Test {
 protected:
  UntrustedSnapshot() {
    window_ = AddWindow(&problem_);
    Must(problem_.SetFixed(window_.poses[0], Fix::kPositionAndYaw));
    Must(problem_.SetFixed(window_.poses[1], Fix::kPosition));
    (void)problem_.Solve({.max_iterations = 2});
    Must(problem_.Marginalize({window_.landmarks[0]}));
    EXPECT_TRUE(problem_.HasFirstEstimate(window_.poses[0]));
    snapshot_ = problem_.GetSnapshot();
  }
  void ExpectRefused(const std::function<void(Snapshot&)>& spoil) {
    const GraphRecord before(problem_);
    Snapshot spoilt = snapshot_;
    spoil(spoilt);
    const Status status = problem_.RestoreSnapshot(spoilt);
    EXPECT_FALSE(status.ok());
    EXPECT_TRUE(GraphRecord(problem_) == before);
    problem_.AcknowledgeRefusal();
    EXPECT_TRUE(problem_.Clone().value().Solve({.max_iterations = 2}).ok());
  }
  /// First number of the k-th vertex's state in a snapshot.
  std::size_t Offset(AnyVertex vertex) const {
    std::size_t at = 0;
    for (const AnyVertex& other : snapshot_.vertices) {
      if (other == vertex) break;
      at += static_cast<std::size_t>(problem_.PoolOf(other.type)->ops().ambient_dim);
    }
    return at;
  }

  Problem problem_;
  Window window_;
  Snapshot snapshot_;
};

TEST_F(UntrustedSnapshot, DimensionsAndBasesOfChartsAreNotBelieved) {
  Problem twin = problem_.Clone();
  for (FreeTangent& tangent : snapshot_.free_tangents) {
    tangent.free_dim = 50;
    tangent.tangent_dim = -3;
    std::fill(std::begin(tangent.basis), std::end(tangent.basis), kNan);
  }
  ASSERT_TRUE(problem_.RestoreSnapshot(snapshot_).ok());
  EXPECT_TRUE(
      SameIterations(problem_.Solve({.max_iterations = 3}), twin.Solve({.max_iterations = 3})));
}

TEST_F(UntrustedSnapshot, ChartsThatAreNone) {
  const auto chart = [](Snapshot& s) -> FreeTangent& {
    return *std::find_if(s.free_tangents.begin(), s.free_tangents.end(),
                         [](const FreeTangent& t) { return t.fix == Fix::kPositionAndYaw; });
  };
  ExpectRefused([&](Snapshot& s) { std::fill_n(chart(s).q0, 4, 0.0); });
  ExpectRefused([&](Snapshot& s) { chart(s).q0[1] = kNan; });
  ExpectRefused([&](Snapshot& s) { chart(s).dphi[0] = kNan; });
  ExpectRefused([&](Snapshot& s) { s.free_tangents.push_back(chart(s)); });
  // A chart of another rotation is anchored anew: held is what is there.
  chart(snapshot_).dphi[0] += 1.0;
  ASSERT_TRUE(problem_.RestoreSnapshot(snapshot_).ok());
  for (const FreeTangent& tangent : problem_.free_tangents()) {
    if (tangent.fix == Fix::kPositionAndYaw) {
      EXPECT_EQ(tangent.dphi[0], 0.0);
    }
  }
}

TEST_F(UntrustedSnapshot, StatesThatAreNone) {
  const std::size_t at = Offset(window_.poses[2]);
  ExpectRefused(
      [&](Snapshot& s) { std::fill_n(s.states.begin() + std::ptrdiff_t(at) + 3, 4, 0.0); });
  ExpectRefused([&](Snapshot& s) { s.states[at + 6] = 2.0; });
  ExpectRefused([&](Snapshot& s) { s.states[at] = kNan; });
  ExpectRefused([&](Snapshot& s) { s.first_estimates[6] = 5.0; });
  ExpectRefused([&](Snapshot& s) { s.first_estimates[0] = kNan; });
}

TEST_F(UntrustedSnapshot, VerticesGivenTwice) {
  // As many as there are, but one of them twice and another missing.
  ExpectRefused([&](Snapshot& s) {
    ASSERT_EQ(s.vertices[0].type, s.vertices[1].type);
    s.vertices[1] = s.vertices[0];
  });
  ExpectRefused([&](Snapshot& s) {
    s.first_estimate_vertices.push_back(s.first_estimate_vertices[0]);
    s.first_estimates.insert(s.first_estimates.end(), 7, 0.0);
    s.first_estimates.back() = 1.0;
  });
}

TEST(UntrustedStates, FirstEstimatesThatAreNoState) {
  Graph graph;
  const auto pose = graph.AddVertex(VertexPose()).value();
  const double zero[7] = {};
  const double twice[7] = {0, 0, 0, 0, 0, 0, 2};
  EXPECT_EQ(graph.SetFirstEstimate(pose, zero).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(graph.SetFirstEstimate(pose, twice).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(graph.SetFirstEstimate(pose, twice).vertex(), AnyVertex(pose));
  EXPECT_FALSE(graph.HasFirstEstimate(pose));
}

TEST(UntrustedStates, PriorsAroundWhatIsNoState) {
  const std::vector<const VertexOps*> types{&kVertexOps<VertexPose>};
  const std::vector<double> r0(6), J(36, 1.0);
  const auto create = [&](std::vector<double> x0) {
    return EdgeMarginalPrior::Create(types, x0, r0, J).status();
  };
  EXPECT_EQ(create({1, 2, 3, 0, 0, 0, 0}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(create({1, 2, 3, 0, 0, 0, 1.1}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(create({1, 2, 3, 0, 0, 0, kNan}).code(), StatusCode::kNotFinite);
  EXPECT_TRUE(create({1, 2, 3, 0, 0, 0, 1}).ok());
}

/// A linear edge of a user's, linearized at a zero quaternion.
class EdgeAroundNothing final : public DynamicEdge {
 public:
  [[nodiscard]] Status CheckVertices(std::span<const VertexOps* const>) const override {
    return {};
  }
  [[nodiscard]] int ResidualDim() const override { return 1; }
  bool Evaluate(std::span<const VertexRef>, double*, double* const*) const override {
    return false;
  }
  [[nodiscard]] const double* LinearizationPoint() const override { return x0_; }
  [[nodiscard]] std::unique_ptr<DynamicEdge> Clone() const override {
    return std::make_unique<EdgeAroundNothing>(*this);
  }

 private:
  double x0_[7] = {};
};

TEST(UntrustedStates, AUsersEdgeAroundWhatIsNoState) {
  Graph graph;
  const AnyVertex vertices[] = {graph.AddVertex(VertexPose()).value()};
  EXPECT_EQ(graph.AddEdge(std::make_unique<EdgeAroundNothing>(), vertices).status().code(),
            StatusCode::kInvalidArgument);
  EXPECT_FALSE(graph.HasFirstEstimate(vertices[0]));
}

TEST(UntrustedStates, AMovedCovarianceAnswers) {
  Problem problem;
  const Window w = AddWindow(&problem);
  Covariance first;
  ASSERT_TRUE(first.Compute(&problem).ok());
  Covariance second = std::move(first);
  // NOLINTBEGIN: use after move
  EXPECT_TRUE(first.Uninformed().empty());
  EXPECT_EQ(first.Joint({w.poses[0]}).status().code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(first.Compute(&problem).ok());
  // NOLINTEND
  EXPECT_TRUE(second.Joint({w.poses[0]}).ok());
}

TEST(UntrustedStates, NeighboursOfTheDeadAreAStatus) {
  Graph graph;
  const Window w = AddWindow(&graph);
  Must(graph.RemoveVertex(w.poses[0]));
  EXPECT_EQ(graph.EdgesOf(w.poses[0]).status().code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(graph.EdgesOf(w.poses[0]).status().vertex(), AnyVertex(w.poses[0]));
  const auto dead = w.priors[0];
  EXPECT_EQ(graph.VerticesOf(dead).status().code(), StatusCode::kUnknownHandle);
  EXPECT_EQ(graph.VerticesOf(dead).status().edge(), AnyEdge(dead));
  EXPECT_EQ(Must(graph.VerticesOf(w.priors[1])), std::vector<AnyVertex>{w.poses[1]});
}

}  // namespace
}  // namespace glissade::test
