// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What a gauge left behind in the graph after a solve: a pose that Gauge::FixedPoses named twice
// stayed fixed.
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

}  // namespace
}  // namespace glissade::test
