// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What a gauge left behind in the graph after a solve: a pose that Gauge::FixedPoses named twice
// stayed fixed, and a gauge prior, an edge that comes and goes, took the linearization points of
// vertices without a marginal prior along.
#include <gtest/gtest.h>

#include "glissade/problem/problem.h"
#include "graph/toy_graphs.h"

namespace glissade::test {
namespace {

TEST(GaugeLeftovers, APoseNamedTwiceIsFreeAfterwards) {
  Problem problem;
  const Window w = AddWindow(&problem);
  SolveOptions options;
  options.max_iterations = 2;
  options.gauge = Gauge::FixedPoses{w.poses[1], w.poses[1]};
  ASSERT_TRUE(problem.Solve(options).ok());
  EXPECT_EQ(problem.GetFixed(w.poses[1]), Fix::kFree);
}

TEST(GaugeLeftovers, AGaugePriorLeavesLinearizationPoints) {
  Problem problem;
  const Window w = AddWindow(&problem);
  const double x_lin[] = {0.25};
  Must(problem.SetFirstEstimate(w.landmarks[0], x_lin));
  SolveOptions options;
  options.max_iterations = 2;
  options.gauge = Gauge::Prior{w.poses[0], 1e3};
  ASSERT_TRUE(problem.Solve(options).ok());
  EXPECT_TRUE(problem.HasFirstEstimate(w.landmarks[0]));
  EXPECT_EQ(problem.LinearizationPoint(w.landmarks[0])[0], 0.25);
}

}  // namespace
}  // namespace glissade::test
