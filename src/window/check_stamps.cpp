// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Stamps that make no sense, and clocks that were set.
#include <string>

#include "window/sliding_window_impl.h"

namespace glissade {

using Verdict = internal::ClockWatch::Verdict;

Status SlidingWindow::Impl::CheckFrameStamp(std::int64_t stamp_ns) const {
  if (frames.empty() && seen.empty()) return {};
  if (stamp_ns <= last_stamp_ns) {
    return {StatusCode::kInvalidArgument, std::string("the frame's stamp ")
                                              .append(std::to_string(stamp_ns))
                                              .append(" is not after the last frame's, ")
                                              .append(std::to_string(last_stamp_ns))};
  }
  if (NanosecondsBetween(last_stamp_ns, stamp_ns) > options.max_frame_gap_ns) {
    return {StatusCode::kInvalidArgument,
            std::string("the frame's stamp is too far after the last frame's: ")
                .append(std::to_string(SecondsBetween(last_stamp_ns, stamp_ns)))
                .append(" s")};
  }
  return {};
}

bool SlidingWindow::Impl::FrameClockWasSet(std::int64_t stamp_ns) {
  if (frames.empty() && seen.empty()) return false;
  return frame_clock.Judge(stamp_ns, last_stamp_ns, options.max_frame_gap_ns) == Verdict::kWasSet;
}

Status SlidingWindow::Impl::AddSample(const ImuSample& sample, bool* clock_was_set) {
  if (imu.counts().accepted > 0) {
    const std::int64_t last = imu.samples().back().stamp_ns;
    switch (imu_clock.Judge(sample.stamp_ns, last, options.max_frame_gap_ns)) {
      case Verdict::kGoesOn:
        break;
      case Verdict::kJumped:
        return {StatusCode::kInvalidArgument, std::string("IMU sample of ")
                                                  .append(std::to_string(sample.stamp_ns))
                                                  .append(" ns: too far from the last one, of ")
                                                  .append(std::to_string(last))
                                                  .append(" ns")};
      case Verdict::kWasSet:
        imu = ImuBuffer(options.imu);
        *clock_was_set = true;
        break;
    }
  }
  const std::int64_t saturated = imu.counts().saturated;
  if (Status s = imu.Add(sample); !s.ok()) return s;
  if (imu.counts().saturated > saturated) Count(WindowEvent::kImuSaturated);
  return {};
}

}  // namespace glissade
