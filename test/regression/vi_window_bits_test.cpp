// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// A visual-inertial window under a marginal prior: the same bits with any number of threads, from a
// clone and again; and no allocation in solving it again.

#include <gtest/gtest.h>

#include <vector>

#include "glissade/glissade.h"
#include "regression/malloc_count.h"
#include "support/vi_walk.h"

namespace glissade {
namespace {

class ViWindowBits : public ::testing::TestWithParam<FirstEstimates> {
 protected:
  void SetUp() override {
    problem_.SetFirstEstimates(GetParam());
    // Enough observations for several chunks of work (one per 1500 edges).
    test::ViWalk walk(3, {.landmarks_per_frame = 60, .track_length = 6});
    walk.Attach(&problem_);
    for (int k = 0; k < 13; ++k)
      walk.AddFrame();
    const auto done = problem_.Marginalize(walk.TakeOldest(), {});
    ASSERT_TRUE(done.ok()) << done.status().message();
    ASSERT_GT(done->tangent_dim, 6 * 4);
    walk.Shake(0.01, 0.1);
    start_ = problem_.GetSnapshot();
  }

  std::vector<double> Solve(Problem* problem, int threads) {
    SolveOptions options;
    options.max_iterations = 5;
    options.num_threads = threads;
    const SolveSummary& summary = problem->Solve(options);
    EXPECT_TRUE(summary.ok()) << summary.BriefReport();
    EXPECT_GT(summary.accepted_steps, 1);
    std::vector<double> numbers = problem->GetSnapshot().states;
    for (const IterationSummary& iteration : summary.iterations)
      numbers.push_back(iteration.cost);
    return numbers;
  }

  Problem problem_;
  Snapshot start_;
};

TEST_P(ViWindowBits, AreTheSameForAnyNumberOfThreadsAndInAClone) {
  ASSERT_GE(problem_.NumEdges(), 3000);
  Problem clone = problem_.Clone();
  const std::vector<double> reference = Solve(&problem_, 1);
  for (const int threads : {1, 2, 4}) {
    SCOPED_TRACE(threads);
    ASSERT_TRUE(problem_.RestoreSnapshot(start_).ok());
    EXPECT_EQ(Solve(&problem_, threads), reference);
  }
  EXPECT_EQ(Solve(&clone, 2), reference);
}

TEST_P(ViWindowBits, ComeWithoutAllocationInASolveAgain) {
  if (test::MallocCount() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  SolveOptions options;
  options.max_iterations = 5;
  ASSERT_TRUE(problem_.Solve(options).ok());
  ASSERT_TRUE(problem_.RestoreSnapshot(start_).ok());
  const std::int64_t before = test::MallocCount();
  const bool ok = problem_.Solve(options).ok();
  EXPECT_EQ(test::MallocCount() - before, 0);
  EXPECT_TRUE(ok);
}

INSTANTIATE_TEST_SUITE_P(Modes, ViWindowBits,
                         ::testing::Values(FirstEstimates::kOff, FirstEstimates::kPriorOnly,
                                           FirstEstimates::kFull));

}  // namespace
}  // namespace glissade
