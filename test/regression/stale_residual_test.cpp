// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Residuals were kept in the edges and stayed those of the trial state after a rejected step; and
// the b of the prior was carried along by adding up steps, rotations too, without a linearization
// point. Here a residual is a function of the present state.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "regression/course_support.h"
#include "support/dense_reference.h"

namespace glissade {
namespace {

/// An observation that remembers its last residual, as the course's edges do.
struct EdgeRemembering : EdgeReprojection {
  std::shared_ptr<double> last_chi2 = std::make_shared<double>(0.0);

  bool Evaluate(const VertexPose& host, const VertexPose& target, const VertexInverseDepth& depth,
                Vector2& r, Jacobian<2, 6>* d_r_d_host, Jacobian<2, 6>* d_r_d_target,
                Jacobian<2, 1>* d_r_d_rho) const {
    const bool ok =
        EdgeReprojection::Evaluate(host, target, depth, r, d_r_d_host, d_r_d_target, d_r_d_rho);
    *last_chi2 = r.squaredNorm();
    return ok;
  }
};

/// The course scene with edges that remember beside edges that do not.
struct Scene {
  Problem problem;
  CourseHandles handles;
  std::vector<EdgeRemembering> remembering;

  Scene() {
    const CourseScene scene = MakeCourseScene();
    handles = AddToGraph(scene, problem).value();
    for (std::size_t k = 0; k < scene.points.size(); ++k) {
      const auto& o = scene.points[k].observations;
      EdgeRemembering edge;
      edge.uv_host = {o[0].u, o[0].v};
      edge.uv_target = {o[1].u, o[1].v};
      remembering.push_back(edge);
      EXPECT_TRUE(
          problem.AddEdge(edge, {handles.poses[0], handles.poses[1], handles.points[k]}).ok());
    }
  }
  /// Chi2 of the observations by pose 1, as the library and as the edges' memory have it.
  [[nodiscard]] double Asked() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < handles.edges.size(); k += 2)
      sum += problem.Chi2(handles.edges[k]).value();
    return sum;
  }
  [[nodiscard]] double Remembered() const {
    double sum = 0.0;
    for (const EdgeRemembering& edge : remembering)
      sum += *edge.last_chi2;
    return sum;
  }
};

TEST(StaleResidual, ChiAfterATakenBackStepIsThatOfTheState) {
  Scene scene;
  const double start = scene.Asked();
  // Summed in the same order from the same residuals: the memory is right while it is fresh.
  ASSERT_TRUE(scene.problem.Cost().ok());
  EXPECT_DOUBLE_EQ(scene.Remembered(), start);

  ASSERT_TRUE(scene.problem.MakeHessian().ok());
  ASSERT_TRUE(scene.problem.SolveLinearSystem(1e-3).ok());
  ASSERT_TRUE(scene.problem.UpdateStates().ok());
  ASSERT_TRUE(scene.problem.Cost().ok());
  EXPECT_LT(scene.Asked(), 0.1 * start);
  ASSERT_TRUE(scene.problem.RollbackStates().ok());

  EXPECT_EQ(scene.Asked(), start);
  EXPECT_LT(scene.Remembered(), 0.1 * start);  // the variant fails the same check
}

TEST(StaleResidual, CostsOfASolveWithRejectedStepsAreThoseOfItsStates) {
  // Poses 60 cm and 0.6 rad off: steps are rejected on the way.
  int rejected = 0;
  for (int sign : {-1, 1}) {
    Problem problem;
    const CourseHandles handles = AddToGraph(MakeCourseScene(), problem).value();
    for (std::size_t n = 0; n < 3; ++n) {
      VertexPose pose = problem.Get(handles.poses[n]);
      const double delta[6] = {0.6 * sign, -0.6,        0.6,
                               0.6,        -0.6 * sign, 0.3 * static_cast<double>(n)};
      pose.Plus(delta);
      ASSERT_TRUE(problem.Set(handles.poses[n], pose).ok());
    }
    std::vector<double> states = problem.GetSnapshot().states;
    SolveOptions options;
    options.initial_lambda = 1e-12;
    options.callback = [&](const IterationSummary& it) {
      EXPECT_NEAR(problem.Cost().value(), it.cost, 1e-12 * it.cost);
      const std::vector<double> now = problem.GetSnapshot().states;
      EXPECT_EQ(it.accepted && it.iteration > 0, now != states) << it.iteration;
      states = now;
      return CallbackAction::kContinue;
    };
    const SolveSummary summary = problem.Solve(options);
    EXPECT_TRUE(summary.ok()) << summary.BriefReport();
    rejected += summary.rejected_steps;
    EXPECT_NEAR(problem.Cost().value(), summary.final_cost, 1e-12 * summary.final_cost);
  }
  EXPECT_GT(rejected, 0);
}

/// The b of a prior on a pose, kept as the course keeps it: b <- b - H dx at every step.
struct AccumulatedPrior {
  Matrix6 H = Matrix6::Identity();
  Vector6 b = Vector6::Zero();
  void Update(const Vector6& dx) { b -= H * dx; }
  void Rollback(const Vector6& dx) { b += H * dx; }
};

/// -d(cost)/d(tangent) by central differences.
Vector6 NumericB(Problem& problem, VertexHandle<VertexPose> handle) {
  const VertexPose x = problem.Get(handle);
  Vector6 b;
  for (int i = 0; i < 6; ++i) {
    double cost[2];
    for (int side = 0; side < 2; ++side) {
      double delta[6] = {};
      delta[i] = side == 0 ? -1e-6 : 1e-6;
      VertexPose moved = x;
      moved.Plus(delta);
      EXPECT_TRUE(problem.Set(handle, moved).ok());
      cost[side] = problem.Cost().value();
    }
    b[i] = -(cost[1] - cost[0]) / 2e-6;
  }
  EXPECT_TRUE(problem.Set(handle, x).ok());
  return b;
}

TEST(StaleResidual, TheBOfAPriorIsTheGradientAtTheState) {
  Problem problem;
  const Pose anchor(so3::ExpQuaternion(Vector3(0.3, -0.2, 0.5)), Vector3(1, 2, 3));
  const auto pose = problem.AddVertex(VertexPose{anchor}).value();
  ASSERT_TRUE(problem.AddEdge(EdgeSE3Prior{anchor}, {pose}).ok());
  AccumulatedPrior accumulated;

  const auto check = [&](const Vector6& b) { return (b - NumericB(problem, pose)).norm() <= 1e-7; };
  const auto ours = [&] {
    EXPECT_TRUE(problem.MakeHessian().ok());
    return Vector6(problem.Rhs());
  };
  EXPECT_TRUE(check(ours()));
  EXPECT_TRUE(check(accumulated.b));

  // Turns about different axes do not add up.
  Vector6 turns[3];
  turns[0] << 0.1, 0.0, 0.0, 0.4, 0.0, 0.0;
  turns[1] << 0.0, 0.1, 0.0, 0.0, 0.4, 0.0;
  turns[2] << 0.0, 0.0, -0.1, -0.4, 0.0, 0.3;
  for (const Vector6& dx : turns) {
    VertexPose x = problem.Get(pose);
    x.Plus(dx.data());
    ASSERT_TRUE(problem.Set(pose, x).ok());
    accumulated.Update(dx);
  }
  EXPECT_TRUE(check(ours()));
  EXPECT_FALSE(check(accumulated.b));
  EXPECT_GT((accumulated.b - NumericB(problem, pose)).norm(), 0.05);

  // One step from the anchor, where both started right.
  ASSERT_TRUE(problem.Set(pose, VertexPose{anchor}).ok());
  EXPECT_TRUE(check(ours()));
}

}  // namespace
}  // namespace glissade
