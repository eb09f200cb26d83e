// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A sliding window allocates nothing once its sizes have settled, whether it flies or stands: every
// sample, frame and refused triangulation once made strings and vectors, 25 a frame.
#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "glissade/sim/noise_source.h"
#include "glissade/sim/recording.h"
#include "glissade/window/sliding_window.h"
#include "regression/malloc_count.h"
#include "window/standing_imu.h"

namespace glissade {
namespace {

constexpr int kWarmUp = 240;  // frames, in flight two laps

/// What sensors say at a frame.
struct Input {
  std::int64_t stamp_ns = 0;
  std::span<const ImuSample> imu;  // since the frame before
  std::vector<FrameObservation> observations;
};

/// Allocations while frames go in, after the first ones.
std::int64_t CountAllocations(SlidingWindow* window, std::span<const Input> inputs) {
  std::int64_t settled = 0;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    if (k == kWarmUp) settled = test::MallocCount();
    const bool taken = window->AddImu(inputs[k].imu).ok() &&
                       window->AddFrame(inputs[k].stamp_ns, inputs[k].observations).ok() &&
                       window->Optimize().ok();
    if (!taken) ADD_FAILURE() << "frame " << k;
  }
  return test::MallocCount() - settled;
}

SlidingWindowOptions OptionsFor(const Viotracks& recording) {
  SlidingWindowOptions options;
  for (const ViotracksCamera& c : recording.cameras)
    options.cameras.push_back({c.fx, c.fy, c.cx, c.cy, c.sigma_px, c.T_b_c});
  options.imu_noise = recording.imu_noise;
  return options;
}

TEST(WindowNoAllocation, InFlight) {
  if (test::MallocCount() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  sim::RecordingOptions of;
  of.world.laps = 4;
  const auto made = sim::MakeRecording(of);
  ASSERT_TRUE(made.ok()) << made.status().message();
  std::vector<Input> inputs(made->frames.size());
  std::size_t next = 0;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    inputs[k].stamp_ns = made->frames[k].stamp_ns;
    const std::size_t begin = next;
    while (next < made->imu.size() &&
           (next == 0 || made->imu[next - 1].stamp_ns < inputs[k].stamp_ns)) {
      ++next;
    }
    inputs[k].imu = std::span(made->imu).subspan(begin, next - begin);
  }
  for (const ViotracksObservation& o : made->tracks)
    inputs[static_cast<std::size_t>(o.frame)].observations.push_back({o.track, o.camera, o.u, o.v});
  SlidingWindow window(OptionsFor(*made));
  // Of 240 frames. Now and then one sees more than any before: then vectors grow.
  EXPECT_LT(CountAllocations(&window, inputs), 24);
  EXPECT_EQ(window.phase(), WindowPhase::kRunning);
  EXPECT_GT(window.total_events()[WindowEvent::kLandmarkMarginalized], 50);
}

TEST(WindowNoAllocation, AtRest) {
  if (test::MallocCount() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  sim::RecordingOptions of;
  const auto made = sim::MakeRecording(of);
  ASSERT_TRUE(made.ok()) << made.status().message();
  const SlidingWindowOptions options = OptionsFor(*made);
  constexpr std::int64_t kFrameNs = 100'000'000;
  test::StandingImu rest;
  rest.seconds = 40.0;
  const std::vector<ImuSample> samples = rest.Read(*options.imu_noise);
  sim::NoiseSource noise(3, 1);
  std::vector<Input> inputs(390);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    inputs[k].stamp_ns = samples.front().stamp_ns + kFrameNs * static_cast<std::int64_t>(k + 1);
    inputs[k].imu = std::span(samples).subspan(k == 0 ? 0 : 1 + 20 * k, k == 0 ? 21 : 20);
    for (int i = 0; i < 60; ++i) {  // a grid, 4 m away
      const double x = -1.5 + 0.3 * (i % 10), y = -0.75 + 0.3 * (i / 10);
      for (int c = 0; c < 2; ++c) {
        const WindowCamera& camera = options.cameras[static_cast<std::size_t>(c)];
        const Vector3 p = camera.T_b_c.Inverse() *
                          (options.cameras[0].T_b_c * Vector3(x, y, 4.0 + 0.1 * (i % 7)));
        const Vector3 e = noise.Normal3(camera.sigma_px);
        inputs[k].observations.push_back({i, c, camera.fx * p[0] / p[2] + camera.cx + e[0],
                                          camera.fy * p[1] / p[2] + camera.cy + e[1]});
      }
    }
  }
  SlidingWindow window(options);
  EXPECT_EQ(CountAllocations(&window, inputs), 0);
  EXPECT_EQ(window.phase(), WindowPhase::kRunning) << window.init_verdict().message;
  EXPECT_GT(window.total_events()[WindowEvent::kStandingStill], 200);
}

}  // namespace
}  // namespace glissade
