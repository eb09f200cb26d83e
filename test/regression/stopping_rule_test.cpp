// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// An absolute stopping rule (|dx|^2 <= 1e-6) and a first lambda taken from the prior: the published
// sweep over prior weights stops early. Poses that start at the truth and hardly move look better
// the heavier the prior is; poses that start elsewhere stay there.
#include <gtest/gtest.h>

#include <array>

#include "glissade/sim/random.h"
#include "regression/course_support.h"

namespace glissade {
namespace {

using test::ConvergedOptions;
using test::CourseOptions;

struct Expected {
  double weight, pose_error, point_error;
};
// Digits as far as they are known: half a unit of the last one is added to the tolerance.
constexpr std::array<Expected, 6> kConverged{{{1e3, 0.00662678, 0.0019507},
                                              {1e4, 0.00673339, 0.0019389},
                                              {1e5, 0.0067447, 0.0019376},
                                              {1e6, 0.00674584, 0.0019375},
                                              {1e7, 0.00674595, 0.0019375},
                                              {1e8, 0.00674596, 0.0019375}}};
constexpr double kFixedPoseError = 0.00674596;
constexpr double kFixedPointError = 0.0019375;

/// Solves with start poses perturbed by `noise` (m, rad) and priors at the truth.
CourseErrors Solve(const CourseGraphOptions& graph, const SolveOptions& options, double noise,
                   std::uint32_t seed) {
  const CourseScene scene = MakeCourseScene();
  Problem problem;
  const CourseHandles handles = AddToGraph(scene, problem, graph).value();
  sim::MinstdRand0 engine(seed);
  sim::NormalReal normal(0.0, noise);
  for (std::size_t n = 0; n < handles.poses.size(); ++n) {
    double delta[6];
    for (double& d : delta)
      d = normal(engine);
    if (static_cast<int>(n) < graph.fix_poses) continue;
    VertexPose pose{scene.poses[n]};
    pose.Plus(delta);
    EXPECT_TRUE(problem.Set(handles.poses[n], pose).ok());
  }
  problem.Solve(options);
  return ErrorsOf(scene, problem, handles);
}

/// The check: the errors of the weight's minimum are reached, to 1e-7.
bool Converges(const Expected& expected, const SolveOptions& options, double noise) {
  for (std::uint32_t seed = 1; seed <= (noise > 0.0 ? 5u : 1u); ++seed) {
    const CourseErrors errors = Solve({.prior_weight = expected.weight}, options, noise, seed);
    if (std::abs(errors.pose - expected.pose_error) > 1e-7) return false;
    if (std::abs(errors.point - expected.point_error) > 1e-7) return false;
  }
  return true;
}

TEST(StoppingRule, ConvergedErrorsFromTheTruthAndFromElsewhere) {
  for (const Expected& expected : kConverged) {
    EXPECT_TRUE(Converges(expected, ConvergedOptions(), 0.0)) << expected.weight;
    EXPECT_TRUE(Converges(expected, ConvergedOptions(), 0.1)) << expected.weight;
    EXPECT_FALSE(Converges(expected, CourseOptions(true), 0.0)) << expected.weight;
    EXPECT_FALSE(Converges(expected, CourseOptions(true), 0.1)) << expected.weight;
  }
}

TEST(StoppingRule, ErrorsTendToThoseOfFixedPosesAsOneOverWeight) {
  const CourseErrors fixed = Solve({.fix_poses = 2}, ConvergedOptions(), 0.1, 1);
  EXPECT_NEAR(fixed.pose, kFixedPoseError, 1e-8);
  EXPECT_NEAR(fixed.point, kFixedPointError, 1e-7);
  double last = 0.0;
  for (const Expected& expected : kConverged) {
    const CourseErrors errors =
        Solve({.prior_weight = expected.weight}, ConvergedOptions(), 0.0, 1);
    const double scaled = expected.weight * (fixed.pose - errors.pose);
    if (expected.weight > 1e3 && expected.weight < 1e7) {
      EXPECT_NEAR(scaled / last, 1.0, 0.06) << expected.weight;
    }
    last = scaled;
  }
}

TEST(StoppingRule, WhatTheCoursesRuleReports) {
  const auto pose_error = [](double weight, double noise) {
    return Solve({.prior_weight = weight}, CourseOptions(true), noise, 1).pose;
  };
  EXPECT_NEAR(pose_error(1e4, 0.0), 0.0060, 5e-5);
  EXPECT_NEAR(pose_error(1e6, 0.0), 0.00011, 5e-6);
  EXPECT_NEAR(pose_error(1e8, 0.0), 0.0000036, 5e-8);
  for (double weight : {1e6, 1e7, 1e8})
    EXPECT_GT(pose_error(weight, 0.1), 10 * kFixedPoseError) << weight;
}

}  // namespace
}  // namespace glissade
