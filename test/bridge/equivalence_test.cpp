// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "common/sanitized.h"
#include "glissade/bridge/ceres.h"
#include "glissade/problem/problem.h"
#include "glissade/sim/course_scene.h"
#include "support/dense_reference.h"
#include "support/random_graph.h"

// Problem and Ceres on the same graph: cost, gradient, H, one Levenberg-Marquardt step at equal
// damping, and the optimum.

namespace glissade::test {
namespace {

using bridge::CeresLinearization;
using bridge::CeresProblem;

void ExpectSameEquations(Problem* problem, const CeresLinearization& ceres) {
  const double cost = problem->Cost().value();
  EXPECT_NEAR(cost, ceres.cost, 1e-12 * ceres.cost);
  EXPECT_EQ(problem->FreeOffsets(), ceres.offsets);
  EXPECT_LT(HessianError(problem->Hessian(), ceres.Hessian()), 1e-11);
  // Near the optimum what is left of the gradient are the last digits of sums that cancel.
  EXPECT_LT(RelativeError(problem->Rhs(), -ceres.gradient), 5e-11);
  // No entry of the gradient hides behind a large one.
  const Eigen::VectorXd b = problem->Rhs();
  for (Eigen::Index i = 0; i < b.size(); ++i) {
    const double scale = ceres.jacobian.col(i).norm() * ceres.residuals.norm();
    EXPECT_NEAR(b[i], -ceres.gradient[i], 1e-12 * scale) << "row " << i;
  }
}

void ExpectSameStep(Problem* problem, const CeresLinearization& ceres, double lambda) {
  SCOPED_TRACE("lambda " + std::to_string(lambda));
  const Status status = problem->SolveLinearSystem(lambda);
  ASSERT_TRUE(status.ok()) << status.message();
  const Eigen::MatrixXd J(ceres.jacobian);
  const Eigen::VectorXd damping = MarquardtDamping(J, lambda);
  const Eigen::VectorXd expected = DampedStep(J, ceres.residuals, damping);
  EXPECT_LT(RelativeError(problem->Step(), expected), 1e-9);
  const Eigen::VectorXd curvature = (J.colwise().squaredNorm().transpose() + damping).cwiseSqrt();
  EXPECT_LT(
      RelativeError(curvature.asDiagonal() * problem->Step(), curvature.asDiagonal() * expected),
      1e-9);
}

/// Both solved until nothing moves any more.
void ExpectSameOptimum(const Problem& problem, int max_iterations = 400) {
  Problem ours = problem.Clone();
  SolveOptions options;
  options.max_iterations = max_iterations;
  options.cost_tolerance = 1e-14;
  options.gradient_tolerance = 1e-13;
  options.step_tolerance = 1e-14;
  const SolveSummary& summary = ours.Solve(options);
  EXPECT_TRUE(summary.converged()) << summary.BriefReport();

  Problem theirs = problem.Clone();
  ceres::Solver::Options ceres_options;
  ceres_options.linear_solver_type = ceres::SPARSE_SCHUR;
  ceres_options.max_num_iterations = max_iterations;
  ceres_options.function_tolerance = 1e-14;
  ceres_options.gradient_tolerance = 1e-14;
  ceres_options.parameter_tolerance = 1e-14;
  ceres_options.max_num_consecutive_invalid_steps = 50;
  const ceres::Solver::Summary ceres_summary = bridge::SolveWithCeres(&theirs, ceres_options);
  EXPECT_TRUE(ceres_summary.IsSolutionUsable()) << ceres_summary.BriefReport();
  EXPECT_NEAR(summary.final_cost, ceres_summary.final_cost, 1e-8 * ceres_summary.final_cost)
      << summary.BriefReport() << "\n"
      << ceres_summary.BriefReport();
  EXPECT_NEAR(ours.Cost().value(), summary.final_cost, 1e-12 * summary.final_cost);
  EXPECT_NEAR(theirs.Cost().value(), ceres_summary.final_cost, 1e-12 * ceres_summary.final_cost);
}

class EquivalenceTest : public testing::TestWithParam<std::tuple<GraphKind, int>> {
 protected:
  static RandomGraphOptions Options(std::uint64_t seed) {
    RandomGraphOptions options;
    options.num_poses = std::get<1>(GetParam());
    options.num_landmarks = options.num_poses * 4;
    options.fixes = seed % 3 != 0;
    options.losses = seed % 4 != 1;
    options.information = seed % 5 != 2;
    options.removals = seed % 2 == 1 && options.num_poses > 4;
    return options;
  }
  static GraphKind Kind() { return std::get<0>(GetParam()); }
};

TEST_P(EquivalenceTest, CostGradientHessianAndStep) {
  const std::uint64_t seeds = kSanitized ? 2 : std::get<1>(GetParam()) <= 12 ? 15 : 4;
  for (std::uint64_t seed = 100; seed < 100 + seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Problem problem(MakeRandomGraph(Kind(), seed, Options(seed)));
    const Status status = problem.MakeHessian();
    ASSERT_TRUE(status.ok()) << status.message();
    const CeresProblem exported = bridge::Export(problem);
    const auto ceres = bridge::Linearize(exported, problem.FreeVertices());
    ASSERT_TRUE(ceres.ok()) << ceres.status().message();
    ExpectSameEquations(&problem, ceres.value());
    ExpectSameStep(&problem, ceres.value(), 1e-4);
    ExpectSameStep(&problem, ceres.value(), 1e-2);
  }
}

// Away from the start, with gauge charts that have moved: after two steps of Problem's own solver.
TEST_P(EquivalenceTest, AfterTwoIterations) {
  for (std::uint64_t seed = 200; seed < (kSanitized ? 201 : 204); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Problem problem(MakeRandomGraph(Kind(), seed, Options(seed)));
    SolveOptions two;
    two.max_iterations = 2;
    ASSERT_TRUE(problem.Solve(two).ok());
    ASSERT_TRUE(problem.MakeHessian().ok());
    const CeresProblem exported = bridge::Export(problem);
    const auto ceres = bridge::Linearize(exported, problem.FreeVertices());
    ASSERT_TRUE(ceres.ok()) << ceres.status().message();
    ExpectSameEquations(&problem, ceres.value());
    ExpectSameStep(&problem, ceres.value(), 1e-3);
  }
}

std::string NameOf(const testing::TestParamInfo<std::tuple<GraphKind, int>>& info) {
  return ToString(std::get<0>(info.param)) + std::to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(AllKinds, EquivalenceTest,
                         testing::Combine(testing::ValuesIn(kAllGraphKinds),
                                          testing::Values(2, 5, 12, 30)),
                         NameOf);

class OptimumTest : public testing::TestWithParam<GraphKind> {};

TEST_P(OptimumTest, SameCost) {
  for (std::uint64_t seed = 0; seed < (kSanitized ? 4 : 25); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomGraphOptions options;
    options.num_poses = 8;
    options.num_landmarks = 40;
    options.min_views = 5;  // few views and redescending losses leave landmarks without a minimum
    options.fixes = seed % 4 != 3;
    options.removals = seed % 3 == 2;
    ExpectSameOptimum(Problem(MakeRandomGraph(GetParam(), seed, options)));
  }
}

INSTANTIATE_TEST_SUITE_P(AllKinds, OptimumTest, testing::ValuesIn(kAllGraphKinds),
                         [](const auto& info) { return ToString(info.param); });

class CourseSceneTest : public testing::TestWithParam<CourseGraphOptions> {};

TEST_P(CourseSceneTest, EquationsStepAndOptimum) {
  Problem problem;
  const auto handles = AddToGraph(MakeCourseScene(), problem, GetParam());
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  ASSERT_TRUE(problem.MakeHessian().ok());
  const CeresProblem exported = bridge::Export(problem);
  const auto ceres = bridge::Linearize(exported, problem.FreeVertices());
  ASSERT_TRUE(ceres.ok());
  ExpectSameEquations(&problem, ceres.value());
  ExpectSameStep(&problem, ceres.value(), 1e-4);
  ExpectSameOptimum(problem);
}

INSTANTIATE_TEST_SUITE_P(Variants, CourseSceneTest,
                         testing::Values(CourseGraphOptions{}, CourseGraphOptions{.fix_poses = 1},
                                         CourseGraphOptions{.fix_poses = 2},
                                         CourseGraphOptions{.prior_weight = 1e3},
                                         CourseGraphOptions{.prior_weight = 1e8}));

}  // namespace
}  // namespace glissade::test
