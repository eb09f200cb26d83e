// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What does not fit goes, and what is left with too little.
#include "glissade/base/index.h"
#include "window/sliding_window_impl.h"

namespace glissade {

using internal::Index;

Status SlidingWindow::RejectOutliers() {
  Impl& w = impl();
  if (w.frames.empty()) return {};
  w.UpdateCamerasInWorld();
  for (WindowLandmark& landmark : w.Landmarks()) {
    if (!landmark.InGraph()) continue;
    const Vector3 X = w.problem.Get(landmark.point).p();
    int left = 0, next = 0;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < landmark.observations.size(); ++i) {
      const LandmarkObservation& o = landmark.observations[i];
      const int frame = w.NextFrameIndex(o.frame, &next);
      if (w.CameraOf(frame, o.camera).SquareInSigmas(X, o) <= w.options.max_chi2) {
        if (o.edge.slot != kNullSlot) ++left;
        if (kept != i) landmark.observations[kept] = o;
        ++kept;
        continue;
      }
      w.Count(WindowEvent::kObservationRejected);
      if (o.edge.slot == kNullSlot) continue;
      if (Status s = w.problem.RemoveEdge(o.edge); !s.ok()) return s;
      --w.frames[Index(frame)].num_observations;
    }
    landmark.observations.resize(kept);
    if (left >= w.options.min_observations) continue;
    if (Status s = w.RemoveFromGraph(&landmark); !s.ok()) return s;
    w.Count(WindowEvent::kLandmarkStarved);
  }
  return {};
}

}  // namespace glissade
