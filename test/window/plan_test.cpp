// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Plans of policies that somebody else wrote: whatever they say, the window stays in one piece.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "common/random_states.h"
#include "common/sanitized.h"
#include "glissade/problem/problem.h"
#include "glissade/window/sliding_window.h"
#include "window/window_run.h"

namespace glissade {
namespace {

using test::MakeFlight;
using test::OptionsFor;
using test::RunWindow;

class Policy : public WindowPolicy {
 public:
  using Rule = std::function<void(const WindowView& window, WindowPlan* plan)>;
  explicit Policy(Rule rule) : rule_(std::move(rule)) {}
  void Decide(const WindowView& window, WindowPlan* plan) override { rule_(window, plan); }

 private:
  Rule rule_;
};

/// Frames that have speed and biases are tied to the one before by one IMU term over just the time
/// between them, or by the prior.
void ExpectOneChain(const SlidingWindow& window) {
  const WindowView view = window.view();
  for (std::size_t k = 1; k < view.frames.size(); ++k) {
    const WindowFrame& from = view.frames[k - 1];
    const WindowFrame& to = view.frames[k];
    ASSERT_LT(from.stamp_ns, to.stamp_ns);
    if (!from.HasSpeedBias() || !to.HasSpeedBias()) continue;
    if (to.imu.slot == kNullSlot) {
      EXPECT_TRUE(window.problem().HasFirstEstimate(to.speed_bias)) << "frame " << to.id;
      continue;
    }
    ASSERT_TRUE(window.problem().Contains(AnyEdge(to.imu))) << "frame " << to.id;
    window.problem().ForEachEdge<EdgeImu>([&](EdgeHandle<EdgeImu> handle, const EdgeImu& edge) {
      if (handle != to.imu) return;
      EXPECT_NEAR(edge.imu.dt, SecondsBetween(from.stamp_ns, to.stamp_ns), 1e-9);
    });
  }
  EXPECT_EQ(static_cast<int>(view.frames.size()), window.problem().NumVertices<VertexPose>());
}

TEST(WindowPlan, NeighboursThatAreDroppedLeaveOneImuTerm) {
  const Viotracks flight = MakeFlight(21);
  SlidingWindowOptions options = OptionsFor(flight);
  int dropped = 0;
  options.policy = std::make_shared<Policy>([&](const WindowView& window, WindowPlan* plan) {
    const int n = static_cast<int>(window.frames.size());
    if (window.frames.back().id % 4 == 0 && n >= 5) plan->drop_frames = {n - 4, n - 3, n - 2};
    if (n > 10) plan->marginalize_frames = {0};
    dropped += static_cast<int>(plan->drop_frames.size());
  });
  SlidingWindow window(options);
  const auto run =
      RunWindow(flight, &window, {}, [](std::size_t, SlidingWindow& w) { ExpectOneChain(w); });
  EXPECT_GT(dropped, 60);
  EXPECT_LT(run.rms_position_m, 0.3);
}

TEST(WindowPlan, WhateverItSaysTheWindowStaysInOnePiece) {
  const Viotracks flight = MakeFlight(22);
  for (std::uint64_t seed = 1; seed <= (test::kSanitized ? 2 : 5); ++seed) {
    test::Random random(static_cast<unsigned>(seed));
    SlidingWindowOptions options = OptionsFor(flight);
    options.policy = std::make_shared<Policy>([&](const WindowView& window, WindowPlan* plan) {
      const int n = static_cast<int>(window.frames.size());
      const int m = static_cast<int>(window.landmarks.size());
      const auto any = [&](std::vector<int>* indices, int limit, double how_many) {
        const int count = static_cast<int>(random.Uniform(0.0, how_many));
        for (int i = 0; i < count; ++i)
          indices->push_back(static_cast<int>(std::floor(random.Uniform(-2.0, limit + 2.0))));
      };
      any(&plan->drop_frames, n, 2.0);
      any(&plan->marginalize_frames, n, n > 8 ? 4.0 : 1.3);
      any(&plan->marginalize_speed_biases, n, 2.0);
      any(&plan->marginalize_landmarks, m, 5.0);
    });
    SlidingWindow window(options);
    int estimates = 0;
    RunWindow(flight, &window, {}, [&](std::size_t, SlidingWindow& w) {
      ASSERT_NO_FATAL_FAILURE(ExpectOneChain(w)) << "seed " << seed;
      ++estimates;
    });
    EXPECT_GT(estimates, 100) << "seed " << seed;
  }
}

}  // namespace
}  // namespace glissade
