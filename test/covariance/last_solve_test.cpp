// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/covariance/last_solve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "glissade/covariance/transform.h"
#include "glissade/problem/problem.h"
#include "support/gauge_scene.h"

// What the system of a solve's last step says, against a fresh linearization where that step began.

namespace glissade::test {
namespace {

std::vector<AnyVertex> States(const GaugeScene& scene) {
  std::vector<AnyVertex> states(scene.poses.begin(), scene.poses.end());
  states.insert(states.end(), scene.speeds.begin(), scene.speeds.end());
  return states;
}

SolveOptions OneStep(const Gauge& gauge, double lambda) {
  SolveOptions options;
  options.gauge = gauge;
  options.initial_lambda = lambda;
  options.max_iterations = 1;
  return options;
}

/// Largest difference of two covariances, in sigmas of the second.
double Difference(const JointCovariance& a, const JointCovariance& b) {
  const Eigen::MatrixXd A = a.Matrix(), B = b.Matrix();
  const Eigen::VectorXd sigma = B.diagonal().cwiseMax(1e-30).cwiseSqrt();
  double worst = 0.0;
  for (Eigen::Index r = 0; r < A.rows(); ++r) {
    for (Eigen::Index c = 0; c < A.cols(); ++c) {
      if (B(r, r) == 0.0 || B(c, c) == 0.0) {
        EXPECT_NEAR(A(r, c), 0.0, 1e-12);
      } else {
        worst = std::max(worst, std::abs(A(r, c) - B(r, c)) / (sigma[r] * sigma[c]));
      }
    }
  }
  return worst;
}

struct Compared {
  JointCovariance solved, fresh;
};

Compared Compare(GaugeScene* scene, const SolveOptions& options) {
  Compared out;
  const std::vector<AnyVertex> states = States(*scene);
  const auto fresh = ComputeCovariance(&scene->problem, states, {.gauge = options.gauge});
  EXPECT_TRUE(fresh.ok()) << fresh.status().message();
  EXPECT_TRUE(scene->problem.Solve(options).ok());
  const auto solved = scene->problem.CovarianceOfLastSolve(states);
  EXPECT_TRUE(solved.ok()) << solved.status().message();
  if (fresh.ok()) out.fresh = fresh.value();
  if (solved.ok()) out.solved = solved.value();
  return out;
}

TEST(CovarianceOfLastSolve, IsThatOfTheLinearizationItsStepCameFrom) {
  for (const bool inverse_depth : {false, true}) {
    for (const LinearSolverType solver :
         {LinearSolverType::kDenseCholesky, LinearSolverType::kSparseCholesky}) {
      GaugeScene scene(4, {.inverse_depth = inverse_depth});
      SolveOptions options = OneStep(Gauge::Fixed{scene.poses[2]}, 1e-12);
      options.linear_solver_type = solver;
      const Compared compared = Compare(&scene, options);
      EXPECT_LT(Difference(compared.solved, compared.fresh), 1e-5);
      EXPECT_EQ(compared.solved.states, compared.fresh.states);
      EXPECT_EQ(compared.solved.gauge.anchor, compared.fresh.gauge.anchor);
    }
  }
}

TEST(CovarianceOfLastSolve, DampingOfTheReducedSystemIsTakenOut) {
  GaugeScene scene(5);
  SolveOptions options = OneStep(Gauge::Fixed{scene.poses[0]}, 1.0);
  options.damping = Damping::kPoseBlock;
  const Compared compared = Compare(&scene, options);
  EXPECT_LT(Difference(compared.solved, compared.fresh), 1e-6);
}

TEST(CovarianceOfLastSolve, AnswersAfterTheGraphHasChangedAsItDidBefore) {
  GaugeScene scene(6);
  const std::vector<AnyVertex> states = States(scene);
  ASSERT_TRUE(scene.problem.Solve(OneStep(Gauge::Fixed{scene.poses[0]}, 1e-12)).ok());
  const auto before = scene.problem.CovarianceOfLastSolve(states);
  ASSERT_TRUE(before.ok());
  ASSERT_TRUE(scene.problem.Marginalize({AnyVertex(scene.poses[0]), scene.speeds[0]}).ok());
  const auto after = scene.problem.CovarianceOfLastSolve(states);
  ASSERT_TRUE(after.ok()) << after.status().message();
  EXPECT_EQ(after->values, before->values);
  EXPECT_EQ(after->states, before->states);
  // In the gauge of a frame that has stayed.
  const auto moved = TransformCovariance(*after, Gauge::Fixed{scene.poses[1]});
  ASSERT_TRUE(moved.ok()) << moved.status().message();
  EXPECT_LT(moved->Block(scene.poses[1])(0, 0), 1e-12);
  EXPECT_GT(moved->Block(scene.poses[0])(0, 0), 1e-9);
}

TEST(CovarianceOfLastSolve, Refusals) {
  GaugeScene scene(7);
  const std::vector<AnyVertex> states = States(scene);
  const Gauge gauge = Gauge::Fixed{scene.poses[0]};
  const auto code = [&](std::vector<AnyVertex> vertices) {
    return scene.problem.CovarianceOfLastSolve(vertices).status().code();
  };
  EXPECT_EQ(code(states), StatusCode::kInvalidArgument);  // no solve yet
  SolveOptions damped = OneStep(gauge, 1e-2);
  ASSERT_TRUE(scene.problem.Solve(damped).ok());
  EXPECT_EQ(code(states), StatusCode::kInvalidArgument);
  SolveOptions implicit = OneStep(gauge, 1e-9);
  implicit.linear_solver_type = LinearSolverType::kImplicitPcg;
  ASSERT_TRUE(scene.problem.Solve(implicit).ok());
  EXPECT_EQ(code(states), StatusCode::kInvalidArgument);
  ASSERT_TRUE(scene.problem.Solve(OneStep(gauge, 1e-9)).ok());
  EXPECT_EQ(code(states), StatusCode::kOk);
  EXPECT_EQ(code({scene.points[0]}), StatusCode::kUnknownHandle);
  EXPECT_EQ(code({states[0], states[0]}), StatusCode::kRepeatedVertex);
  EXPECT_EQ(code({}), StatusCode::kOk);
  // A solve that fails, also before it has made a step.
  SolveOptions bad = OneStep(gauge, 1e-9);
  bad.max_iterations = -1;
  ASSERT_FALSE(scene.problem.Solve(bad).ok());
  EXPECT_EQ(code(states), StatusCode::kInvalidArgument);
  ASSERT_TRUE(scene.problem.Solve(OneStep(gauge, 1e-9)).ok());
  EXPECT_EQ(code(states), StatusCode::kOk);
  ASSERT_TRUE(scene.problem.MakeHessian().ok());
  EXPECT_EQ(code(states), StatusCode::kInvalidArgument);
  // Nothing holds the scene, and damping alone made the step.
  ASSERT_TRUE(scene.problem.Solve(OneStep({}, 1e-9)).ok());
  EXPECT_EQ(code(states), StatusCode::kSingular);
}

}  // namespace
}  // namespace glissade::test
