// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Initialisation in motion at evenly spaced places of recordings with a real IMU. Four places each
// by default; GLISSADE_INIT_PLACES says how many else (docs/initialization.md: 20).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <tuple>
#include <vector>

#include "common/data_dir.h"
#include "common/sanitized.h"
#include "window/motion_input.h"

namespace glissade {
namespace {

using test::MotionErrors;
using test::MotionInput;

class RecordedMotion : public testing::TestWithParam<std::tuple<const char*, bool>> {};

double Median(std::vector<double> x) {
  if (x.empty()) return 0.0;
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

/// Places where it moves. From the tenth frame after one on, with every frame, until two seconds
/// are over.
TEST_P(RecordedMotion, InitialisesWithinTwoSeconds) {
  if (test::kSanitized) GTEST_SKIP() << "simulated motion walks through the same code";
  const auto [name, mono] = GetParam();
  const auto folder = test::DataDir() / "vio" / name;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const Viotracks recording = ReadViotracks(folder.string()).value();
  const char* wanted = std::getenv("GLISSADE_INIT_PLACES");
  const std::size_t places = wanted ? std::strtoul(wanted, nullptr, 10) : 4;
  MotionInput flight(recording, mono);
  std::vector<std::size_t> moving;
  for (std::size_t k = 0; k + 21 < recording.frames.size(); ++k) {
    if (recording.ground_truth[k].speed_bias->v().norm() > 0.1) moving.push_back(k);
  }
  int initialized = 0, scale = 0, gravity = 0, velocity = 0, attempts = 0;
  std::vector<double> scales, tilts, speeds, seconds;
  double cpu = 0.0;
  for (std::size_t place = 0; place < places; ++place) {
    const std::size_t begin = moving[moving.size() * place / places];
    for (std::size_t count = 10; count <= 21; ++count) {
      const InitializationInput input = flight.Window(begin, count);
      const std::clock_t start = std::clock();
      InitVerdict verdict;
      const auto state = InitializeInMotion(input, &verdict);
      cpu += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      ++attempts;
      if (!state.ok()) continue;
      ++initialized;
      const MotionErrors errors(*state, recording.ground_truth);
      scale += std::abs(errors.log_scale) < 2.0 * state->log_scale_sigma ? 1 : 0;
      gravity += errors.gravity < 2.45 * state->gravity_sigma ? 1 : 0;
      velocity += errors.velocity < 2.8 * state->velocity_sigma ? 1 : 0;
      scales.push_back(std::abs(errors.log_scale));
      tilts.push_back(errors.gravity);
      speeds.push_back(errors.velocity);
      seconds.push_back(0.1 * static_cast<double>(count - 1));
      break;
    }
  }
  std::printf(
      "%s, %s: initialised at %d of %zu places, median after %.1f s; median error of log scale "
      "%.3f, gravity %.2f deg, velocity %.3f m/s; within 2 sigma %d, %d, %d; %.1f ms an attempt\n",
      name, mono ? "mono" : "stereo", initialized, places, Median(seconds), Median(scales),
      57.296 * Median(tilts), Median(speeds), scale, gravity, velocity, 1e3 * cpu / attempts);
  const auto most = static_cast<int>(places);
  EXPECT_GE(initialized, most - most / 20);
  // The truth is no truth to 2 sigma of stereo (it has absorbed noise): 85 %.
  EXPECT_GE(scale, initialized - 1 - most * 3 / 20);
  EXPECT_GE(gravity, initialized - 1 - most / 20);
  EXPECT_GE(velocity, initialized - 1 - most / 20);
}

INSTANTIATE_TEST_SUITE_P(Euroc, RecordedMotion,
                         testing::Combine(testing::Values("euroc_v101_map", "euroc_mh05_map"),
                                          testing::Bool()));

/// One real camera on a car at 2.5 Hz, whose stamps are 0.11 s late. With that put right it
/// initialises while driving; left as it is, the fit with the IMU refuses.
TEST(RecordedMotionOfACar, MonoNeedsTheTimeOffset) {
  const auto folder = test::DataDir() / "vio" / "malaga_parking6L";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const char* wanted = std::getenv("GLISSADE_INIT_PLACES");
  if (!wanted) GTEST_SKIP() << "takes a second a place: set GLISSADE_INIT_PLACES";
  const std::size_t places = std::strtoul(wanted, nullptr, 10);
  for (const std::int64_t late_ns : {std::int64_t{110'000'000}, std::int64_t{0}}) {
    Viotracks recording = ReadViotracks(folder.string()).value();
    for (ViotracksFrame& frame : recording.frames)
      frame.stamp_ns -= late_ns;
    for (GroundTruthState& state : recording.ground_truth)
      state.stamp_ns -= late_ns;
    MotionInput drive(recording, true);
    std::size_t initialized = 0, scale = 0;
    std::vector<double> scales;
    for (std::size_t place = 0; place < places; ++place) {
      const std::size_t begin = 14 + 132 * place / places;
      for (std::size_t count = 5; count <= 14; ++count) {
        const auto state = InitializeInMotion(drive.Window(begin, count));
        if (!state.ok()) continue;
        ++initialized;
        const MotionErrors errors(*state, recording.ground_truth);
        scales.push_back(std::abs(errors.log_scale));
        scale += scales.back() < 2.0 * state->log_scale_sigma ? 1u : 0u;
        break;
      }
    }
    std::printf(
        "malaga_parking6L, mono, stamps moved by %.2f s: initialised at %zu of %zu places, log "
        "scale %.3f in the median, within 2 sigma %zu\n",
        1e-9 * static_cast<double>(late_ns), initialized, places, Median(scales), scale);
    if (late_ns > 0) {
      EXPECT_GE(2 * initialized, places);
      EXPECT_GE(scale + 1 + places / 20, initialized);
    } else {
      EXPECT_LE(5 * initialized, places + 5);
    }
  }
}

}  // namespace
}  // namespace glissade
