// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/window_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "glissade/io/replay.h"
#include "glissade/sim/recording.h"

namespace glissade::test {

Viotracks MakeFlight(std::uint64_t seed, int laps) {
  sim::RecordingOptions options;
  options.seed = seed;
  options.world.seed = seed;
  options.world.laps = laps;
  auto recording = sim::MakeRecording(options);
  EXPECT_TRUE(recording.ok()) << recording.status().message();
  return std::move(recording).value();
}

SlidingWindowOptions OptionsFor(const Viotracks& recording, std::size_t num_cameras) {
  SlidingWindowOptions options;
  options.cameras = WindowCameras(recording, num_cameras);
  options.imu_noise = recording.imu_noise;
  options.gravity = recording.gravity.norm();
  return options;
}

WindowState TruthAt(const Viotracks& recording, std::size_t frame) {
  const std::int64_t stamp = recording.frames[frame].stamp_ns;
  const auto at = std::lower_bound(
      recording.ground_truth.begin(), recording.ground_truth.end(), stamp,
      [](const GroundTruthState& state, std::int64_t t) { return state.stamp_ns < t; });
  EXPECT_TRUE(at != recording.ground_truth.end() && at->stamp_ns == stamp);
  WindowState state;
  state.stamp_ns = stamp;
  state.T_w_b = at->T_w_b;
  if (at->speed_bias) state.speed_bias = *at->speed_bias;
  return state;
}

WindowRun RunWindow(const Viotracks& recording, SlidingWindow* window, const Tamper& tamper,
                    const Inspect& inspect) {
  WindowRun run;
  ViotracksReplay replay(recording, {.num_cameras = 2});
  double squares = 0.0;
  while (replay.Next()) {
    std::int64_t stamp = replay.stamp_ns();
    std::vector<ImuSample> imu(replay.imu().begin(), replay.imu().end());
    std::vector<FrameObservation> observations(replay.observations().begin(),
                                               replay.observations().end());
    const bool use = !tamper || tamper(replay.frame(), &stamp, &imu, &observations);
    if (recording.imu_noise) static_cast<void>(window->AddImu(imu));
    if (!use) continue;
    if (window->phase() == WindowPhase::kInitializing) {
      const Status started =
          window->Start(TruthAt(recording, replay.frame()),
                        {.tilt = 0.01, .speed = 0.02, .accel_bias = 0.02, .gyro_bias = 0.002});
      EXPECT_TRUE(started.ok()) << started.message();
      EXPECT_TRUE(window->Associate(observations).ok());
      EXPECT_TRUE(window->TriangulateTracks().ok());
      continue;
    }
    if (!window->AddFrame(stamp, observations).ok()) {
      ++run.refused_frames;
      continue;
    }
    const Status solved = window->Optimize();
    EXPECT_TRUE(solved.ok()) << "frame " << replay.frame() << ": " << solved.message();
    run.estimates.push_back(window->newest());
    run.frames.push_back(replay.frame());
    squares +=
        (window->newest().T_w_b.p() - TruthAt(recording, replay.frame()).T_w_b.p()).squaredNorm();
    if (inspect) inspect(replay.frame(), *window);
  }
  run.rms_position_m = std::sqrt(squares / static_cast<double>(run.estimates.size()));
  return run;
}

}  // namespace glissade::test
