// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// A sliding window with marginalization allocates nothing once its sizes have settled: the new
// prior takes the storage of the old one.

#include <gtest/gtest.h>

#include <vector>

#include "glissade/glissade.h"
#include "regression/malloc_count.h"
#include "support/vi_walk.h"

namespace glissade {
namespace {

class MarginalizeNoAllocation
    : public ::testing::TestWithParam<std::tuple<FirstEstimates, MarginalForm>> {};

TEST_P(MarginalizeNoAllocation, InAThousandTurnsAfterTheFirstFifty) {
  if (test::MallocCount() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  Problem problem;
  problem.SetFirstEstimates(std::get<0>(GetParam()));
  test::ViWalk walk(1);
  walk.Attach(&problem);
  for (int k = 0; k < 6; ++k)
    walk.AddFrame();
  SolveOptions options;
  options.max_iterations = 3;
  MarginalizeOptions marginalize;
  marginalize.form = std::get<1>(GetParam());
  std::vector<AnyVertex> oldest;
  std::int64_t settled = 0;
  for (int turn = 0; turn < 1000; ++turn) {
    if (turn == 50) settled = test::MallocCount();
    walk.AddFrame();
    ASSERT_TRUE(problem.Solve(options).ok());
    walk.TakeOldest(&oldest);
    const auto done = problem.Marginalize(oldest, marginalize);
    ASSERT_TRUE(done.ok()) << done.status().message();
    ASSERT_EQ(done->tangent_dim, 6 * 4 + 9);
  }
  EXPECT_EQ(test::MallocCount() - settled, 0);
}

INSTANTIATE_TEST_SUITE_P(
    ModesAndForms, MarginalizeNoAllocation,
    ::testing::Combine(::testing::Values(FirstEstimates::kOff, FirstEstimates::kPriorOnly,
                                         FirstEstimates::kFull),
                       ::testing::Values(MarginalForm::kSquareRootQr, MarginalForm::kSchur)));

}  // namespace
}  // namespace glissade
