// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/minimizer/solver_choice.h"

#include <gtest/gtest.h>

#include <string>

#include "glissade/glissade.h"
#include "glissade/io/bal.h"
#include "glissade/sim/city.h"
#include "glissade/structure/structure.h"

namespace glissade {
namespace {

Problem MakeCityProblem(int cameras) {
  sim::CityOptions options;
  options.num_cameras = cameras;
  Problem problem;
  EXPECT_TRUE(MoveToGraph(sim::MakeCity(options).value(), problem).ok());
  return problem;
}

TEST(SolverChoice, SaysWhatItTookAndWhy) {
  Problem problem = MakeCityProblem(60);
  SolveOptions options;
  options.max_iterations = 1;
  const SolveSummary& summary = problem.Solve(options);
  ASSERT_TRUE(summary.ok()) << summary.BriefReport();
  EXPECT_EQ(summary.reduced.scalars, 60 * 9);
  EXPECT_GT(summary.reduced.density, 0.1);
  EXPECT_LE(summary.reduced.density, 1.0);
  EXPECT_STRNE(summary.reduced.name, "");
  EXPECT_STRNE(summary.reduced.reason, "");
  options.linear_solver_type = LinearSolverType::kImplicitPcg;
  EXPECT_STREQ(problem.Solve(options).reduced.name, "implicit-pcg");
  EXPECT_STREQ(problem.Solve(options).reduced.reason, "asked for");
}

TEST(SolverChoice, MemoryLimitLooksForASolverThatNeedsLessOrRefuses) {
  Problem problem = MakeCityProblem(60);
  SolveOptions options;
  options.max_iterations = 2;
  const auto of = [&](LinearSolverType type) {
    options.linear_solver_type = type;
    return problem.EstimateMemory(options).value().total();
  };
  const std::int64_t dense = of(LinearSolverType::kDenseCholesky);
  const std::int64_t implicit = of(LinearSolverType::kImplicitPcg);
  ASSERT_LT(implicit, dense);
  options.linear_solver_type = LinearSolverType::kAuto;
  options.memory_limit = implicit;
  const SolveSummary& summary = problem.Solve(options);
  ASSERT_TRUE(summary.ok()) << summary.BriefReport();
  EXPECT_STREQ(summary.reduced.name, "implicit-pcg");
  EXPECT_STREQ(summary.reduced.reason, "others would exceed memory_limit");
  EXPECT_LE(summary.reduced.memory_bytes, options.memory_limit);

  // Too little for any, and for the one that was asked for: states stay.
  const std::vector<double> states = problem.GetSnapshot().states;
  options.memory_limit = implicit - 1;
  EXPECT_EQ(problem.Solve(options).status.code(), StatusCode::kOutOfMemory);
  options.memory_limit = implicit;
  options.linear_solver_type = LinearSolverType::kDenseCholesky;
  const Status status = problem.Solve(options).status;
  EXPECT_EQ(status.code(), StatusCode::kOutOfMemory);
  EXPECT_NE(status.message().find("memory_limit is"), std::string::npos) << status.message();
  options.memory_limit = 1000;
  EXPECT_EQ(problem.Solve(options).status.code(), StatusCode::kOutOfMemory);
  EXPECT_EQ(problem.GetSnapshot().states, states);
  options.memory_limit = -1;
  EXPECT_EQ(problem.Solve(options).status.code(), StatusCode::kInvalidArgument);
}

TEST(SolverChoice, EstimateMemoryRefusesOptionsThatMakeNoSense) {
  Problem problem = MakeCityProblem(20);
  SolveOptions options;
  options.num_threads = 0;
  EXPECT_EQ(problem.EstimateMemory(options).status().code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(problem.EstimateMemory().ok());
}

// Above so many edges the records of edges are given back: solving again, after a change too, and
// what analyzes anew, go on to work.
TEST(SolverChoice, WhatALargeSolveGaveBackIsMadeAgainWhereItIsNeeded) {
  Problem problem = MakeCityProblem(260);
  ASSERT_GE(problem.NumEdges(), Structure::kManyEdges);
  SolveOptions options;
  options.max_iterations = 1;
  const double first = problem.Solve(options).final_cost;
  const double second = problem.Solve(options).final_cost;
  EXPECT_LT(second, first);
  EXPECT_TRUE(problem.EstimateMemory(options).ok());
  const double third = problem.Solve(options).final_cost;
  EXPECT_LT(third, second);
  ASSERT_TRUE(problem.SetFixed(*problem.Vertices().front().As<VertexCameraBal>()).ok());
  EXPECT_TRUE(problem.Solve(options).ok());
  ASSERT_TRUE(problem.MakeHessian().ok());
  EXPECT_TRUE(problem.SolveLinearSystem(1e-3, options).ok());
  EXPECT_TRUE(problem.Solve(options).ok());
}

}  // namespace
}  // namespace glissade
