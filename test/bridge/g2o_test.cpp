// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "glissade/bridge/ceres.h"
#include "glissade/io/g2o.h"
#include "glissade/losses/huber.h"
#include "glissade/problem/problem.h"
#include "support/g2o_scene.h"

// Pose graphs of g2o's files, against Ceres.

namespace glissade::test {
namespace {

TEST(G2oCeres, FindsTheSameOptimum) {
  for (const Loss& loss : {Loss(), Loss(Huber{1.0})}) {
    const G2oProblem start = MakeG2oScene(60, 11);
    Problem problem;
    const auto handles = AddToGraph(start, problem, {.loss = loss});
    ASSERT_TRUE(handles.ok()) << handles.status().message();
    EXPECT_EQ(handles->held, 100);
    Graph for_ceres = static_cast<const Graph&>(problem).Clone().value();
    const SolveSummary& ours = problem.Solve({.max_iterations = 100, .cost_tolerance = 1e-14});
    ASSERT_TRUE(ours.ok()) << ours.status.message();
    ceres::Solver::Options options;
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-14;
    options.gradient_tolerance = options.parameter_tolerance = 0.0;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.logging_type = ceres::SILENT;
    const ceres::Solver::Summary theirs = bridge::SolveWithCeres(&for_ceres, options);
    ASSERT_TRUE(theirs.IsSolutionUsable());
    EXPECT_NEAR(ours.initial_cost, theirs.initial_cost, 1e-12 * theirs.initial_cost);
    EXPECT_NEAR(ours.final_cost, theirs.final_cost, 1e-10 * theirs.final_cost);
    for (const auto& pose : handles->poses) {
      Vector6 difference;
      problem.Get(pose).Minus(for_ceres.Get(pose), difference.data());
      EXPECT_LT(difference.norm(), 1e-6);
    }
  }
}

}  // namespace
}  // namespace glissade::test
