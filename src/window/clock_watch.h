// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/imu/sample.h"

namespace glissade::internal {

/// Tells a wrong stamp from a clock that was set: after a jump to and fro a stream goes on where it
/// was, and what lies between is refused; a clock that was set stays where it is, and refusing its
/// stamps for ever would end the estimate.
class ClockWatch {
 public:
  /// Believes a jump after so many stamps in a row, each a little later than the one before.
  explicit ClockWatch(int believes_after) : believes_after_(believes_after) {}

  enum class Verdict : std::uint8_t { kGoesOn, kJumped, kWasSet };

  /// Of the next stamp of a stream whose last accepted one is `last_ns`: whether it lies within
  /// `limit_ns` of it on either side.
  Verdict Judge(std::int64_t stamp_ns, std::int64_t last_ns, std::int64_t limit_ns) {
    const bool is_near = Distance(stamp_ns, last_ns) <= limit_ns;
    if (is_near) {
      in_a_row_ = 0;
      return Verdict::kGoesOn;
    }
    const bool follows =
        in_a_row_ > 0 && stamp_ns > jumped_to_ns_ && Distance(stamp_ns, jumped_to_ns_) <= limit_ns;
    in_a_row_ = follows ? in_a_row_ + 1 : 1;
    jumped_to_ns_ = stamp_ns;
    if (in_a_row_ < believes_after_) return Verdict::kJumped;
    in_a_row_ = 0;
    return Verdict::kWasSet;
  }

 private:
  static std::int64_t Distance(std::int64_t a, std::int64_t b) {
    return a < b ? NanosecondsBetween(a, b) : NanosecondsBetween(b, a);
  }

  int believes_after_;
  int in_a_row_ = 0;
  std::int64_t jumped_to_ns_ = 0;
};

}  // namespace glissade::internal
