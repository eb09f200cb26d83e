// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <span>

#include "glissade/base/index.h"
#include "glissade/window/policy.h"
#include "window/leaving_landmarks.h"

namespace glissade {

using internal::Index;

namespace {

/// The part of the landmarks that a frame sees which the newest frame still sees.
double SeenShare(const WindowView& window, const WindowFrame& frame) {
  int all = 0, seen = 0;
  for (const WindowLandmark& landmark : window.landmarks) {
    if (!landmark.InGraph()) continue;
    for (const LandmarkObservation& o : landmark.observations) {
      if (o.frame != frame.id) continue;
      ++all;
      if (landmark.NewestFrame() == window.frames.back().id) ++seen;
      break;
    }
  }
  return all > 0 ? static_cast<double>(seen) / static_cast<double>(all) : 0.0;
}

/// Engel et al., Eq. (20): high for a keyframe among others and far from the newest frame.
double Crowding(const WindowView& window, std::span<const int> keyframes, int k) {
  const auto distance = [&](int i, int j) {
    return (window.frames[Index(i)].T_w_b.p() - window.frames[Index(j)].T_w_b.p()).norm();
  };
  double sum = 0.0;
  for (const int j : keyframes) {
    if (j != k) sum += 1.0 / (distance(k, j) + 1e-5);
  }
  return std::sqrt(distance(k, static_cast<int>(window.frames.size()) - 1)) * sum;
}

}  // namespace

void LeastSeenKeyframePolicy::Decide(const WindowView& window, WindowPlan* plan) {
  const int newest_old = static_cast<int>(window.frames.size()) - num_frames_ - 1;
  std::vector<int> keyframes;  // oldest first
  for (int k = 0; k <= newest_old; ++k) {
    const WindowFrame& frame = window.frames[Index(k)];
    if (frame.HasSpeedBias()) plan->marginalize_speed_biases.push_back(k);
    if (frame.is_keyframe) {
      keyframes.push_back(k);
    } else {
      plan->marginalize_frames.push_back(k);
    }
  }
  while (static_cast<int>(keyframes.size()) > num_keyframes_) {
    // The two newest have had no time to be seen from elsewhere.
    const std::size_t candidates = keyframes.size() > 2 ? keyframes.size() - 2 : 1;
    std::size_t leaving = 0;
    double worst = -1.0;
    for (std::size_t i = 0; i < candidates; ++i) {
      if (SeenShare(window, window.frames[Index(keyframes[i])]) < min_seen_share_) {
        leaving = i;
        break;
      }
      const double crowding = Crowding(window, keyframes, keyframes[i]);
      if (crowding > worst) {
        worst = crowding;
        leaving = i;
      }
    }
    plan->marginalize_frames.push_back(keyframes[leaving]);
    keyframes.erase(keyframes.begin() + static_cast<std::ptrdiff_t>(leaving));
  }
  if (newest_old >= 0) {
    internal::MarginalizeUnseenLandmarks(window, window.frames[Index(newest_old)].id, plan);
  }
}

}  // namespace glissade
