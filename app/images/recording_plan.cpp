// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/recording_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace glissade::app {

namespace {

constexpr double kMaxGapS = 1.0;

std::vector<ImuSample> ReadingsOf(const std::vector<ImuSample>& imu, std::int64_t first_ns,
                                  std::int64_t last_ns) {
  const auto earlier = [](const ImuSample& s, std::int64_t t) { return s.stamp_ns < t; };
  auto begin = std::lower_bound(imu.begin(), imu.end(), first_ns, earlier);
  if (begin != imu.begin() && (begin == imu.end() || begin->stamp_ns > first_ns)) --begin;
  auto end = std::lower_bound(begin, imu.end(), last_ns, earlier);
  if (end != imu.end()) ++end;
  return {begin, end};
}

}  // namespace

Result<vision::ImageRecording> PlanRecording(const FlightSource& source, const PlanOptions& options,
                                             const std::string& folder, Flight* flight) {
  const auto refused = [](std::string why) {
    return Status(StatusCode::kInvalidArgument, std::move(why));
  };
  const std::int64_t begin_ns = flight->begin_ns();
  const double there_is_s = SecondsBetween(begin_ns, flight->end_ns());
  if (options.start_s > there_is_s) {
    return refused(fmt::format("--start: the flight lasts {:.3f} s", there_is_s));
  }
  const double left_s = there_is_s - options.start_s;
  const double seconds = options.seconds > 0.0 ? std::min(options.seconds, left_s) : left_s;
  const std::int64_t first_ns = begin_ns + std::llround(1e9 * options.start_s);
  // The last frame is not later than the truth; frames of n seconds end one before n.
  const double count = options.seconds > 0.0 && options.seconds <= left_s
                           ? std::ceil(seconds * options.rate_hz - 1e-6)
                           : std::floor(seconds * options.rate_hz + 1e-6) + 1.0;

  vision::ImageRecording recording;
  recording.layout = "EuRoC";
  recording.cameras = source.cameras;
  if (options.mono) recording.cameras.resize(1);
  for (double k = 0.0; k < std::max(count, 1.0); k += 1.0) {
    const std::int64_t stamp_ns = first_ns + std::llround(1e9 * k / options.rate_hz);
    if (stamp_ns > flight->end_ns()) break;
    if (const double gap = flight->GapAt(stamp_ns); gap > kMaxGapS) {
      return refused(fmt::format("the truth says nothing for {:.2f} s around {:.2f} s", gap,
                                 SecondsBetween(begin_ns, stamp_ns)));
    }
    vision::ImageFrame& frame = recording.frames.emplace_back();
    frame.stamp_ns = stamp_ns;
    for (std::size_t c = 0; c < recording.cameras.size(); ++c) {
      frame.files.push_back(
          vision::EurocImagePath(folder, static_cast<int>(c), stamp_ns, options.ending));
    }
    recording.ground_truth.push_back(flight->At(stamp_ns));
  }
  recording.imu_noise = source.imu_noise;
  recording.imu_rate_hz = source.imu_rate_hz;
  recording.imu =
      ReadingsOf(source.imu, recording.frames.front().stamp_ns, recording.frames.back().stamp_ns);
  return recording;
}

}  // namespace glissade::app
