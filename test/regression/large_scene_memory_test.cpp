// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// A thousand cameras took a square matrix of 9000 x 9000 numbers, and one more for each chunk of
// the work: 5.9 GB. What a solve allocates goes with the blocks that there are.

#include <gtest/gtest.h>

#include "glissade/problem/problem.h"
#include "regression/malloc_count.h"
#include "support/bal_city.h"

namespace glissade {
namespace {

struct Memory {
  double peak = 0.0;  // bytes over what the graph takes
  double cost_ratio = 0.0;
};

Memory SolveCity(int num_cameras, LinearSolverType type) {
  Problem problem(test::MakeBalCity(num_cameras, 7));
  SolveOptions options;
  options.linear_solver_type = type;
  options.max_iterations = 2;
  options.pcg.tolerance = 1e-3;
  const std::int64_t before = test::HeapBytes();
  test::ResetPeakHeap();
  const SolveSummary& summary = problem.Solve(options);
  EXPECT_TRUE(summary.ok()) << summary.status.message();
  EXPECT_EQ(summary.num_poses, num_cameras);
  return {static_cast<double>(test::PeakHeapBytes() - before),
          summary.final_cost / summary.initial_cost};
}

class LargeSceneMemory : public testing::TestWithParam<LinearSolverType> {};

TEST_P(LargeSceneMemory, GoesWithTheBlocks) {
  if (test::HeapBytes() < 0) GTEST_SKIP() << "the heap cannot be counted here";
  const Memory small = SolveCity(250, GetParam());
  const Memory large = SolveCity(1000, GetParam());
  EXPECT_LT(small.cost_ratio, 0.1);
  EXPECT_LT(large.cost_ratio, 0.1);
  // Four times the cameras: sixteen times the square. Elimination fills in: of a plane n log n.
  EXPECT_LT(large.peak, 6.0 * small.peak);
  const double square = 8.0 * 9000.0 * 9000.0;
  EXPECT_LT(large.peak, square / 4.0);
  RecordProperty("megabytes", static_cast<int>(large.peak / 1e6));
}

INSTANTIATE_TEST_SUITE_P(Solvers, LargeSceneMemory,
                         testing::Values(LinearSolverType::kAuto, LinearSolverType::kSparseCholesky,
                                         LinearSolverType::kPcg, LinearSolverType::kImplicitPcg),
                         [](const auto& info) -> std::string {
                           switch (info.param) {
                             case LinearSolverType::kAuto:
                               return "Auto";
                             case LinearSolverType::kPcg:
                               return "Pcg";
                             case LinearSolverType::kImplicitPcg:
                               return "ImplicitPcg";
                             default:
                               return "SparseCholesky";
                           }
                         });

}  // namespace
}  // namespace glissade
