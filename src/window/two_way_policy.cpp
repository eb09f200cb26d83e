// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/index.h"
#include "glissade/window/policy.h"
#include "window/leaving_landmarks.h"

namespace glissade {

using internal::Index;

void TwoWayPolicy::Decide(const WindowView& window, WindowPlan* plan) {
  const int size = static_cast<int>(window.frames.size());
  if (size <= num_frames_ || size < 3) return;
  if (!window.frames[Index(size - 2)].is_keyframe) {
    plan->drop_frames.push_back(size - 2);
    return;
  }
  plan->marginalize_frames.push_back(0);
  internal::MarginalizeUnseenLandmarks(window, window.frames.back().id, plan);
}

}  // namespace glissade
