// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Numbers that overflowed came out as good ones: sums of finite Chi2 and the constant cost of a
// marginalization as inf, kappa of a null space as NaN, each with an ok status; and Cost() refused
// what a solve had just minimized, where a bounded loss made a cost of a residual beyond double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "glissade/problem/problem.h"

namespace glissade {
namespace {

EdgeSE3Prior PriorAt(double x) {
  EdgeSE3Prior prior;
  prior.T_w_b.data[0] = x;
  return prior;
}

/// Hardly depends on the pose, and is large: what brings it to zero is out of reach.
struct EdgeNearlyDeaf {
  using Vertices = VertexList<VertexPose>;
  static constexpr int kResidualDim = 6;
  bool Evaluate(const VertexPose&, Vector<6>& r, Jacobian<6, 6>* d_r_d_pose) const {
    r.setConstant(100.0);
    if (d_r_d_pose != nullptr) *d_r_d_pose = 1e-153 * Jacobian<6, 6>::Identity();
    return true;
  }
};

TEST(Overflow, OfAStepThatIsAppliedIsAStatus) {
  Problem problem;
  const auto pose = problem.AddVertex(VertexPose()).value();
  ASSERT_TRUE(problem.AddEdge(EdgeNearlyDeaf{}, {pose}).ok());
  const Snapshot before = problem.GetSnapshot();
  ASSERT_TRUE(problem.MakeHessian().ok());
  ASSERT_TRUE(problem.SolveLinearSystem(0.0).ok());
  const Status status = problem.UpdateStates();
  EXPECT_EQ(status.code(), StatusCode::kNotFinite) << status.message();
  EXPECT_EQ(status.vertex(), AnyVertex(pose));
  EXPECT_EQ(problem.GetSnapshot().states, before.states);
  EXPECT_FALSE(problem.RollbackStates().ok());
}

/// Where its variable is positive, derivatives that overflow as soon as a residual multiplies them.
struct EdgeSteepBeyondZero {
  using Vertices = VertexList<VertexVector<1>>;
  static constexpr int kResidualDim = 2;
  bool Evaluate(const VertexVector<1>& x, Vector2& r, Jacobian<2, 1>* d_r_d_x) const {
    r << x.Data()[0] - 10.0, 100.0;
    if (d_r_d_x != nullptr) *d_r_d_x << 1.0, (x.Data()[0] > 0.0 ? 1e307 : 0.0);
    return true;
  }
};

TEST(Overflow, OfTheGradientAfterAStepIsNoNumberOfAnIteration) {
  Problem problem;
  const auto x = problem.AddVertex(VertexVector<1>{}).value();
  ASSERT_TRUE(problem.AddEdge(EdgeSteepBeyondZero{}, {x}).ok());
  const SolveSummary& summary = problem.Solve();
  EXPECT_EQ(summary.status.code(), StatusCode::kNotFinite);
  EXPECT_EQ(summary.accepted_steps, 1);
  for (const IterationSummary& iteration : summary.iterations) {
    EXPECT_TRUE(std::isfinite(iteration.cost));
    EXPECT_TRUE(std::isfinite(iteration.gradient_max));
  }
}

/// So steep that the square is no number.
struct EdgeTooSteep {
  using Vertices = VertexList<VertexVector<1>>;
  static constexpr int kResidualDim = 1;
  bool Evaluate(const VertexVector<1>&, Vector<1>& r, Jacobian<1, 1>* d_r_d_x) const {
    r[0] = 1.0;
    if (d_r_d_x != nullptr) (*d_r_d_x)(0, 0) = 1e160;
    return true;
  }
};

// It was "converged", at the start: no gradient counts beside an infinite curvature.
TEST(Overflow, OfTheCurvatureIsNoConvergence) {
  Problem problem;
  const auto x = problem.AddVertex(VertexVector<1>{}).value();
  ASSERT_TRUE(problem.AddEdge(EdgeTooSteep{}, {x}).ok());
  const SolveSummary& summary = problem.Solve();
  EXPECT_EQ(summary.status.code(), StatusCode::kNotFinite) << summary.BriefReport();
}

/// Has no solution, whatever the damping.
class HopelessSolver final : public LinearSolver {
 public:
  SchurForm Form(const SchurLayout&) override { return SchurForm::kDense; }
  LinearSolverResult Prepare(const SchurOperator&) override { return {}; }
  LinearSolverResult Solve(const SchurOperator&, const double*, double*,
                           const SolveRequest&) override {
    return {};
  }
};

TEST(Overflow, OfTheDampingIsNoNumberOfAnIteration) {
  Problem problem;
  const auto pose = problem.AddVertex(VertexPose()).value();
  ASSERT_TRUE(problem.AddEdge(PriorAt(1.0), {pose}).ok());
  HopelessSolver solver;
  SolveOptions options;
  options.linear_solver = &solver;
  options.max_iterations = 1000;
  options.max_lambda = std::numeric_limits<double>::max();
  const SolveSummary& summary = problem.Solve(options);
  EXPECT_FALSE(summary.ok());
  EXPECT_GT(summary.iterations.size(), 10U);
  for (const IterationSummary& iteration : summary.iterations)
    EXPECT_TRUE(std::isfinite(iteration.lambda));
}

TEST(Overflow, OfASumIsAStatus) {
  Graph graph;
  const auto pose = graph.AddVertex(VertexPose()).value();
  for (int k = 0; k < 3; ++k)
    ASSERT_TRUE(graph.AddEdge(PriorAt(1.2e154), {pose}).ok());
  for (const AnyEdge& edge : graph.Edges()) {
    const Result<double> one = graph.Chi2(edge);
    ASSERT_TRUE(one.ok());
    EXPECT_TRUE(std::isfinite(*one));
  }
  EXPECT_EQ(graph.Chi2().status().code(), StatusCode::kNotFinite);
  EXPECT_EQ(graph.Cost().status().code(), StatusCode::kNotFinite);
}

TEST(Overflow, UnderABoundedLossHasACost) {
  Problem problem;
  const auto pose = problem.AddVertex(VertexPose()).value();
  EdgeOptions<EdgeSE3Prior> bounded;
  bounded.loss = Tukey{1.0};
  ASSERT_TRUE(problem.AddEdge(PriorAt(1e160), {pose}, bounded).ok());
  ASSERT_TRUE(problem.AddEdge(PriorAt(1.0), {pose}).ok());
  const SolveSummary& summary = problem.Solve();
  ASSERT_TRUE(summary.ok()) << summary.status.message();
  const Result<double> cost = problem.Cost();
  ASSERT_TRUE(cost.ok()) << cost.status().message();
  EXPECT_NEAR(*cost, summary.final_cost, 1e-12);
}

TEST(Overflow, OfWhatAMarginalizationLeavesOutIsAStatus) {
  Problem problem;
  const auto pose = problem.AddVertex(VertexPose()).value();
  ASSERT_TRUE(problem.AddEdge(PriorAt(1e155), {pose}).ok());
  ASSERT_TRUE(problem.AddEdge(PriorAt(-1e155), {pose}).ok());
  const auto done = problem.Marginalize({pose});
  EXPECT_EQ(done.status().code(), StatusCode::kNotFinite);
  EXPECT_EQ(problem.NumEdges(), 2);
}

TEST(Overflow, OfTheInformationAboutAGaugeIsAStatus) {
  Problem problem;
  const auto a = problem.AddVertex(VertexPose()).value();
  const auto b = problem.AddVertex(VertexPose()).value();
  EdgeOptions<EdgeRelativePose> weight;
  weight.sqrt_information = 1e153 * SquareMatrix<6>::Identity();
  for (int k = 0; k < 200; ++k)
    ASSERT_TRUE(problem.AddEdge(EdgeRelativePose(), {a, b}, weight).ok());
  const auto report = problem.CheckNullspace();
  EXPECT_EQ(report.status().code(), StatusCode::kNotFinite) << report.status().message();
}

TEST(Overflow, OfAVertexThatIsMovedIsAStatus) {
  Problem problem;
  ASSERT_TRUE(problem.AddVertex(VertexPose()).ok());
  VertexSpeedBias fast;
  fast.data[0] = fast.data[1] = 1.5e308;  // turned by 45 degrees, along y: 2.1e308
  const auto moving = problem.AddVertex(fast).value();
  OrbitMotion turn;
  const double c = std::sqrt(0.5);
  const double R[9] = {c, -c, 0.0, c, c, 0.0, 0.0, 0.0, 1.0};
  std::copy_n(R, 9, turn.R);
  const Status status = MoveAlongOrbit(&problem, turn, {.group = GaugeGroup::kVisualInertial});
  EXPECT_EQ(status.code(), StatusCode::kNotFinite) << status.message();
  EXPECT_EQ(status.vertex(), AnyVertex(moving));
  EXPECT_EQ(problem.Get(moving).data[0], 1.5e308);
  EXPECT_EQ(problem.Get(moving).data[1], 1.5e308);
}

}  // namespace
}  // namespace glissade
