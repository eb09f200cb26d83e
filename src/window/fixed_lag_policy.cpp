// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/index.h"
#include "glissade/imu/sample.h"
#include "glissade/window/policy.h"
#include "window/leaving_landmarks.h"

namespace glissade {

void FixedLagPolicy::Decide(const WindowView& window, WindowPlan* plan) {
  const std::int64_t newest = window.frames.back().stamp_ns;
  // Two frames at least: one alone has nothing to compare itself with.
  for (std::size_t k = 0; k + 2 < window.frames.size(); ++k) {
    if (SecondsBetween(window.frames[k].stamp_ns, newest) <= lag_s_) break;
    plan->marginalize_frames.push_back(static_cast<int>(k));
  }
  internal::MarginalizeUnseenLandmarks(window, window.frames.back().id, plan);
}

}  // namespace glissade
