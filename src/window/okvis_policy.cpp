// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/index.h"
#include "glissade/window/policy.h"
#include "window/leaving_landmarks.h"

namespace glissade {

using internal::Index;

void OkvisPolicy::Decide(const WindowView& window, WindowPlan* plan) {
  const int newest_old = static_cast<int>(window.frames.size()) - num_frames_ - 1;
  if (newest_old < 0) return;
  int keyframes = 0;
  for (int k = newest_old; k >= 0; --k) {
    const WindowFrame& frame = window.frames[Index(k)];
    if (frame.HasSpeedBias()) plan->marginalize_speed_biases.push_back(k);
    if (frame.is_keyframe && keyframes < num_keyframes_) {
      ++keyframes;
    } else {
      plan->marginalize_frames.push_back(k);
    }
  }
  internal::MarginalizeUnseenLandmarks(window, window.frames[Index(newest_old)].id, plan);
}

}  // namespace glissade
