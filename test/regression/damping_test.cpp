// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The course damped the poses only, while its gain ratio reckoned with damping of all variables
// (and with 1e-3 on top); and its first lambda was 1e-5 max diag(H), so that a prior of weight 1e8
// damped everything to a standstill.
#include <gtest/gtest.h>

#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/vector.h"
#include "regression/course_support.h"

namespace glissade {
namespace {

/// Offset of a landmark from a station: linear.
struct EdgeOffset {
  using Vertices = VertexList<VertexVector<3>, VertexPointXYZ>;
  static constexpr int kResidualDim = 3;
  Vector3 measured = Vector3::Zero();
  bool Evaluate(const VertexVector<3>& station, const VertexPointXYZ& point, Vector3& r,
                Jacobian<3, 3>* d_r_d_station, Jacobian<3, 3>* d_r_d_point) const {
    r = point.p() - Eigen::Map<const Vector3>(station.Data()) - measured;
    if (d_r_d_station) *d_r_d_station = -Matrix3::Identity();
    if (d_r_d_point) d_r_d_point->setIdentity();
    return true;
  }
};

/// Three stations, the first one fixed, see five landmarks; start far from the solution.
void BuildLinearProblem(Problem& problem) {
  std::vector<VertexHandle<VertexVector<3>>> stations;
  for (int k = 0; k < 3; ++k)
    stations.push_back(problem.AddVertex(VertexVector<3>{{1.0 * k, 0.0, 0.5}}));
  EXPECT_TRUE(problem.SetFixed(stations[0]).ok());
  for (int l = 0; l < 5; ++l) {
    const auto point = problem.AddVertex(VertexPointXYZ(0.5 * l, 2.0, -1.0)).value();
    for (int k = 0; k < 3; ++k) {
      const Vector3 measured(0.7 * l - 0.3 * k, 1.0 + 0.2 * k * l, 0.4 * k);
      EXPECT_TRUE(
          problem.AddEdge(EdgeOffset{measured}, {stations[static_cast<std::size_t>(k)], point})
              .ok());
    }
  }
}

/// The check: on a linear problem the model is exact, so every gain ratio is 1.
bool GainRatiosAreOne(Damping damping, double initial_lambda) {
  Problem problem;
  BuildLinearProblem(problem);
  SolveOptions options;
  options.damping = damping;
  options.initial_lambda = initial_lambda;
  options.max_iterations = 4;
  const SolveSummary summary = problem.Solve(options);
  EXPECT_GE(summary.accepted_steps, 2) << summary.BriefReport();
  for (const IterationSummary& it : summary.iterations) {
    const bool measurable = it.cost_change > 1e-6 * summary.initial_cost;
    if (measurable && std::abs(it.gain_ratio - 1.0) > 1e-8) return false;
  }
  return true;
}

TEST(Damping, GainRatioReckonsWithTheDampingThatWasUsed) {
  for (double lambda : {1e-2, 1.0}) {
    EXPECT_TRUE(GainRatiosAreOne(Damping::kDiagonal, lambda));
    EXPECT_TRUE(GainRatiosAreOne(Damping::kIdentity, lambda));
    EXPECT_FALSE(GainRatiosAreOne(Damping::kPoseBlock, lambda));
  }
}

/// How far pose 2, which has no prior, comes from 5 cm off in the first step.
double FirstStepOfPose2(double weight, const SolveOptions& options) {
  const CourseScene scene = MakeCourseScene();
  Problem problem;
  const CourseHandles handles = AddToGraph(scene, problem, {.prior_weight = weight}).value();
  VertexPose start{scene.poses[2]};
  const double delta[6] = {0.05, -0.05, 0.05, 0.0, 0.0, 0.0};
  start.Plus(delta);
  EXPECT_TRUE(problem.Set(handles.poses[2], start).ok());
  SolveOptions once = options;
  once.max_iterations = 1;
  EXPECT_EQ(problem.Solve(once).accepted_steps, 1);
  return (problem.Get(handles.poses[2]).pose.p() - start.pose.p()).norm();
}

/// The check: a heavy prior on others leaves pose 2's step as a light one does.
bool HeavyPriorLeavesStepsAlone(const SolveOptions& options) {
  const double ratio = FirstStepOfPose2(1e8, options) / FirstStepOfPose2(1e3, options);
  return ratio > 0.9 && ratio < 1.1;
}

TEST(Damping, AHeavyPriorDoesNotDampTheRest) {
  EXPECT_TRUE(HeavyPriorLeavesStepsAlone(test::ConvergedOptions()));
  EXPECT_FALSE(HeavyPriorLeavesStepsAlone(test::CourseOptions(false)));
}

/// The check: converged to the minimum's pose error within ten steps, from 5 cm off.
bool ConvergesInTenSteps(double weight, double pose_error, SolveOptions options) {
  const CourseScene scene = MakeCourseScene();
  Problem problem;
  const CourseHandles handles = AddToGraph(scene, problem, {.prior_weight = weight}).value();
  for (const auto& handle : handles.poses) {
    VertexPose start = problem.Get(handle);
    const double delta[6] = {0.05, -0.05, 0.05, 0.02, 0.02, -0.02};
    start.Plus(delta);
    EXPECT_TRUE(problem.Set(handle, start).ok());
  }
  options.max_iterations = 10;
  problem.Solve(options);
  return std::abs(ErrorsOf(scene, problem, handles).pose - pose_error) < 1e-7;
}

TEST(Damping, ConvergenceDoesNotSlowDownWithTheWeight) {
  for (const auto& [weight, error] : {std::pair{1e5, 0.0067447}, std::pair{1e8, 0.00674596}}) {
    EXPECT_TRUE(ConvergesInTenSteps(weight, error, test::ConvergedOptions())) << weight;
    EXPECT_FALSE(ConvergesInTenSteps(weight, error, test::CourseOptions(false))) << weight;
  }
}

}  // namespace
}  // namespace glissade
