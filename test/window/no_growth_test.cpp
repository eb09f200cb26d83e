// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A window that flies for long takes no more memory at the end than after the first minute.
// GLISSADE_FLIGHT_SECONDS makes it longer, and says how long a frame took then and then.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <vector>

#include "common/sanitized.h"
#include "glissade/io/replay.h"
#include "glissade/window/sliding_window.h"
#include "window/window_run.h"

namespace glissade {
namespace {

/// Resident memory of this program (MB); 0 where the system does not say.
double ResidentMegabytes() {
  std::ifstream statm("/proc/self/statm");
  double all = 0.0, resident = 0.0;
  statm >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576.0;
}

double ThreadMilliseconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// After a minute of flight.
struct Minute {
  double resident_mb = 0.0;
  double median_ms = 0.0;  ///< of its frames
};

TEST(SlidingWindow, TakesNoMoreMemoryTheLongerItFlies) {
  const char* asked = std::getenv("GLISSADE_FLIGHT_SECONDS");
  const double seconds = asked != nullptr ? std::max(132.0, std::atof(asked)) : 132.0;
  if (test::kSanitized) GTEST_SKIP() << "sanitizers keep what was freed";
  constexpr double kLapSeconds = 12.0, kFramesPerMinute = 600.0;
  const Viotracks flight = test::MakeFlight(1, static_cast<int>(seconds / kLapSeconds));
  SlidingWindow window(test::OptionsFor(flight));
  ViotracksReplay replay(flight);
  std::vector<Minute> minutes;
  minutes.reserve(static_cast<std::size_t>(seconds / 60.0) + 1);
  std::vector<double> ms;
  ms.reserve(static_cast<std::size_t>(kFramesPerMinute));
  std::size_t most_frames = 0, most_landmarks = 0;
  ASSERT_TRUE(window
                  .Start(test::TruthAt(flight, 0),
                         {.tilt = 0.01, .speed = 0.02, .accel_bias = 0.02, .gyro_bias = 0.002})
                  .ok());
  ASSERT_TRUE(replay.Next());
  ASSERT_TRUE(window.AddImu(replay.imu()).ok());
  while (replay.Next()) {
    const double begin = ThreadMilliseconds();
    ASSERT_TRUE(window.AddImu(replay.imu()).ok());
    ASSERT_TRUE(window.AddFrame(replay.stamp_ns(), replay.observations()).ok());
    ASSERT_TRUE(window.Optimize().ok());
    ms.push_back(ThreadMilliseconds() - begin);
    most_frames = std::max(most_frames, window.view().frames.size());
    most_landmarks = std::max(most_landmarks, window.view().landmarks.size());
    if (ms.size() < static_cast<std::size_t>(kFramesPerMinute)) continue;
    minutes.push_back({ResidentMegabytes(), Median(ms)});
    ms.clear();
  }
  ASSERT_GE(minutes.size(), 2u);
  const Minute &first = minutes.front(), &last = minutes.back();
  if (asked != nullptr) {
    std::printf("minute 1: %.3f ms a frame, %.1f MB; minute %zu: %.3f ms, %.1f MB\n",
                first.median_ms, first.resident_mb, minutes.size(), last.median_ms,
                last.resident_mb);
  }
  EXPECT_EQ(window.total_events()[WindowEvent::kReset], 0);
  EXPECT_LE(most_frames, 10u);
  EXPECT_LE(most_landmarks, 400u);
  // Storage that grows to its largest size, once.
  EXPECT_LE(last.resident_mb, first.resident_mb + 2.0);
}

}  // namespace
}  // namespace glissade
