// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Same input, same bits: for any number of threads, in a clone, from a snapshot, and whatever was
// removed before.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "glissade/glissade.h"

namespace glissade {
namespace {

/// Frames along x that see what the frames before them host; a third of the landmarks with a loss
/// that has no kernel.
void Build(Problem* problem, int num_frames, int landmarks_per_frame, bool with_detours) {
  std::vector<VertexHandle<VertexPose>> frames;
  for (int k = 0; k < num_frames; ++k) {
    const Pose start(so3::ExpQuaternion(Vector3(0.01 * std::sin(k), 0.0, 0.005 * k)),
                     Vector3(0.2 * k, 0.02 * std::cos(k), 0.0));
    if (with_detours) {
      const VertexHandle<VertexPose> detour = problem->AddVertex(VertexPose{});
      ASSERT_TRUE(problem->RemoveVertex(detour).ok());
    }
    frames.push_back(problem->AddVertex(VertexPose{start}));
  }
  ASSERT_TRUE(problem->SetFixed(frames[0]).ok());
  ASSERT_TRUE(problem->SetFixed(frames[1], Fix::kPosition).ok());
  for (int k = 0; k + 4 < num_frames; ++k) {
    for (int l = 0; l < landmarks_per_frame; ++l) {
      const auto depth = problem->AddVertex(VertexInverseDepth{0.15 + 0.001 * l});
      for (int t = 1; t <= 4; ++t) {
        EdgeReprojection edge;
        edge.uv_host = Vector2(0.5 * std::sin(l), 0.4 * std::cos(3 * l));
        edge.uv_target =
            edge.uv_host + Vector2(-0.03 * t + 0.001 * std::sin(7 * l + t), 0.001 * std::cos(l));
        EdgeOptions<EdgeReprojection> options;
        options.sqrt_information = Matrix2(300.0 * Matrix2::Identity());
        if (l % 3 == 0) options.loss = Cauchy{3.0};
        const auto added = problem->AddEdge(
            edge,
            {frames[static_cast<std::size_t>(k)], frames[static_cast<std::size_t>(k + t)], depth},
            options);
        ASSERT_TRUE(added.ok());
      }
    }
  }
}

struct Bits {
  std::vector<double> states, costs;
};

Bits Solve(Problem* problem, int threads) {
  SolveOptions options;
  options.max_iterations = 6;
  options.num_threads = threads;
  const SolveSummary& summary = problem->Solve(options);
  EXPECT_TRUE(summary.ok()) << summary.BriefReport();
  EXPECT_GT(summary.accepted_steps, 1);
  Bits bits{problem->GetSnapshot().states, {}};
  for (const IterationSummary& iteration : summary.iterations)
    bits.costs.push_back(iteration.cost);
  return bits;
}

void ExpectSameBits(const Bits& a, const Bits& b) {
  ASSERT_EQ(a.states.size(), b.states.size());
  ASSERT_EQ(a.costs.size(), b.costs.size());
  EXPECT_EQ(std::memcmp(a.states.data(), b.states.data(), a.states.size() * sizeof(double)), 0);
  EXPECT_EQ(std::memcmp(a.costs.data(), b.costs.data(), a.costs.size() * sizeof(double)), 0);
}

class Determinism : public ::testing::TestWithParam<int> {};

TEST_P(Determinism, ThreadsClonesAndSnapshots) {
  const int landmarks = GetParam();
  Problem problem;
  Build(&problem, 14, landmarks, false);
  const Snapshot start = problem.GetSnapshot();
  Problem clone = problem.Clone();
  const Bits reference = Solve(&problem, 1);
  for (const int threads : {1, 2, 4}) {
    SCOPED_TRACE(threads);
    ASSERT_TRUE(problem.RestoreSnapshot(start).ok());
    ExpectSameBits(Solve(&problem, threads), reference);
  }
  ExpectSameBits(Solve(&clone, 2), reference);
}

// 1 to 8 chunks of work.
INSTANTIATE_TEST_SUITE_P(Sizes, Determinism, ::testing::Values(5, 40, 120, 320));

TEST(RemovalHistory, LeavesNoTrace) {
  Problem plain, detour;
  Build(&plain, 14, 40, false);
  Build(&detour, 14, 40, true);
  ExpectSameBits(Solve(&detour, 1), Solve(&plain, 1));
}

}  // namespace
}  // namespace glissade
