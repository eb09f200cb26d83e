// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/leaving_landmarks.h"

#include <algorithm>

#include "glissade/base/index.h"

namespace glissade::internal {

void MarginalizeUnseenLandmarks(const WindowView& window, std::int64_t seen_since,
                                WindowPlan* plan) {
  if (plan->marginalize_frames.empty()) return;
  const auto leaves = [&](const LandmarkObservation& o) {
    return std::any_of(plan->marginalize_frames.begin(), plan->marginalize_frames.end(),
                       [&](int k) { return window.frames[Index(k)].id == o.frame; });
  };
  for (std::size_t l = 0; l < window.landmarks.size(); ++l) {
    const WindowLandmark& landmark = window.landmarks[l];
    if (landmark.InGraph() && landmark.NewestFrame() < seen_since &&
        std::any_of(landmark.observations.begin(), landmark.observations.end(), leaves)) {
      plan->marginalize_landmarks.push_back(static_cast<int>(l));
    }
  }
}

}  // namespace glissade::internal
