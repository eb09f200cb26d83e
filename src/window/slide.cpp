// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What the policy lets go becomes a prior.
#include <algorithm>
#include <string>

#include "glissade/base/index.h"
#include "window/sliding_window_impl.h"

namespace glissade {

using internal::Index;

namespace {

void SortedOnce(std::vector<int>* indices, int limit) {
  std::sort(indices->begin(), indices->end());
  indices->erase(std::unique(indices->begin(), indices->end()), indices->end());
  std::erase_if(*indices, [&](int i) { return i < 0 || i >= limit; });
}

bool Holds(const std::vector<int>& sorted, int i) {
  return std::binary_search(sorted.begin(), sorted.end(), i);
}

}  // namespace

/// Makes of the policy's plan one that can be carried out, whatever it said: indices that exist,
/// once each; the newest frame stays, and a dropped frame that a prior knows is marginalized.
void SlidingWindow::Impl::CompletePlan() {
  const int newest = static_cast<int>(frames.size()) - 1;
  SortedOnce(&plan.marginalize_frames, newest);
  SortedOnce(&plan.marginalize_speed_biases, newest);
  SortedOnce(&plan.drop_frames, newest);
  SortedOnce(&plan.marginalize_landmarks, static_cast<int>(num_landmarks));
  std::erase_if(plan.drop_frames, [&](int k) {
    if (Holds(plan.marginalize_frames, k)) return true;
    const WindowFrame& frame = frames[Index(k)];
    const bool free_of_priors =
        !problem.HasFirstEstimate(frame.pose) && k > 0 &&
        (!HasImu() || (frame.HasSpeedBias() && frames[Index(k - 1)].HasSpeedBias() &&
                       !problem.HasFirstEstimate(frame.speed_bias)));
    if (!free_of_priors) plan.marginalize_frames.push_back(k);
    return !free_of_priors;
  });
  SortedOnce(&plan.marginalize_frames, newest);
  std::erase_if(plan.marginalize_speed_biases, [&](int k) {
    return !frames[Index(k)].HasSpeedBias() || Holds(plan.marginalize_frames, k) ||
           Holds(plan.drop_frames, k);
  });
  std::erase_if(plan.marginalize_landmarks, [&](int l) { return !landmarks[Index(l)].InGraph(); });
}

/// Observations that a prior is not to know: of landmarks that stay, those in frames that leave; of
/// landmarks that leave, those in frames that are dropped.
Status SlidingWindow::Impl::DropObservations() {
  const bool all_stay = std::all_of(fates.begin(), fates.end(),
                                    [](FrameFate fate) { return fate == FrameFate::kStays; });
  if (all_stay && plan.marginalize_landmarks.empty()) return {};
  for (std::size_t l = 0; l < num_landmarks; ++l) {
    const bool leaves = Holds(plan.marginalize_landmarks, static_cast<int>(l));
    WindowLandmark& landmark = landmarks[l];
    std::size_t kept = 0;
    int in_graph = 0, at = 0;
    for (std::size_t i = 0; i < landmark.observations.size(); ++i) {
      const LandmarkObservation& o = landmark.observations[i];
      const int frame = NextFrameIndex(o.frame, &at);
      const FrameFate fate = fates[Index(frame)];
      if (fate == FrameFate::kStays || (fate == FrameFate::kMarginalized && leaves)) {
        in_graph += o.edge.slot != kNullSlot ? 1 : 0;
        if (kept != i) landmark.observations[kept] = o;
        ++kept;
      } else if (o.edge.slot != kNullSlot) {
        if (Status s = problem.RemoveEdge(o.edge); !s.ok()) return s;
        --frames[Index(frame)].num_observations;
      }
    }
    landmark.observations.resize(kept);
    if (!leaves || in_graph >= options.min_observations) continue;
    // Nothing is left that a prior could say of others.
    std::erase(plan.marginalize_landmarks, static_cast<int>(l));
    if (Status s = RemoveFromGraph(&landmark); !s.ok()) return s;
    Count(WindowEvent::kLandmarkStarved);
  }
  return {};
}

/// One IMU term in place of those before, between and after frames that go, from the first to the
/// last of neighbours.
Status SlidingWindow::Impl::JoinImuTerms(int first, int last) {
  WindowFrame& before = frames[Index(first - 1)];
  WindowFrame& after = frames[Index(last + 1)];
  const VertexSpeedBias& state = problem.Get(before.speed_bias);
  ImuPreintegration joined;
  if (Status s = Integrate(before.stamp_ns, after.stamp_ns, {state.ba(), state.bg()}, &joined);
      !s.ok()) {
    return s;
  }
  const EdgeHandle<EdgeImu> old = after.imu;
  if (Status s = AddImuTerm(joined, &before, &after); !s.ok()) return s;
  preintegrations[Index(last + 1)] = joined;
  if (old.slot != kNullSlot) return problem.RemoveEdge(old);
  return {};
}

Status SlidingWindow::Slide() {
  Impl& w = impl();
  if (w.frames.empty()) return {};
  w.plan.Clear();
  w.options.policy->Decide(view(), &w.plan);
  w.CompletePlan();
  const WindowPlan& plan = w.plan;

  w.fates.assign(w.frames.size(), FrameFate::kStays);
  for (const int k : plan.marginalize_frames)
    w.fates[Index(k)] = FrameFate::kMarginalized;
  for (const int k : plan.drop_frames)
    w.fates[Index(k)] = FrameFate::kDropped;
  if (Status s = w.DropObservations(); !s.ok()) return s;

  for (std::size_t i = 0; w.HasImu() && i < plan.drop_frames.size(); ++i) {
    const int first = plan.drop_frames[i];
    while (i + 1 < plan.drop_frames.size() && plan.drop_frames[i + 1] == plan.drop_frames[i] + 1)
      ++i;
    if (Status s = w.JoinImuTerms(first, plan.drop_frames[i]); !s.ok()) return s;
  }
  // With them goes all that ties them to others, before a prior comes to know them by it.
  for (const int k : plan.drop_frames) {
    if (w.HasImu()) {
      if (Status s = w.problem.RemoveVertex(w.frames[Index(k)].speed_bias); !s.ok()) return s;
    }
    if (Status s = w.problem.RemoveVertex(w.frames[Index(k)].pose); !s.ok()) return s;
  }
  w.leaving.clear();
  for (const int k : plan.marginalize_frames) {
    w.leaving.emplace_back(w.frames[Index(k)].pose);
    if (w.frames[Index(k)].HasSpeedBias()) w.leaving.emplace_back(w.frames[Index(k)].speed_bias);
  }
  for (const int k : plan.marginalize_speed_biases)
    w.leaving.emplace_back(w.frames[Index(k)].speed_bias);
  for (const int l : plan.marginalize_landmarks)
    w.leaving.emplace_back(w.landmarks[Index(l)].point);
  if (!w.leaving.empty()) {
    const auto done = w.problem.Marginalize(w.leaving);
    if (!done.ok()) {
      static_cast<void>(w.problem.AcknowledgeRefusal());
      return done.status();
    }
  }
  // Their IMU terms have become part of the prior.
  for (const int k : plan.marginalize_frames)
    w.frames[Index(k) + 1].imu = {};
  for (const int k : plan.marginalize_speed_biases) {
    w.frames[Index(k)].speed_bias = {};
    w.frames[Index(k)].imu = {};
    w.frames[Index(k) + 1].imu = {};
  }
  w.Count(WindowEvent::kLandmarkMarginalized,
          static_cast<std::int64_t>(plan.marginalize_landmarks.size()));
  // From the last one on: each that goes is replaced by the last.
  for (auto l = plan.marginalize_landmarks.rbegin(); l != plan.marginalize_landmarks.rend(); ++l) {
    WindowLandmark& landmark = w.landmarks[Index(*l)];
    for (const LandmarkObservation& o : landmark.observations) {
      if (o.edge.slot != kNullSlot) --w.frames[Index(w.FrameIndex(o.frame))].num_observations;
    }
    w.ForgetLandmark(Index(*l));
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < w.frames.size(); ++k) {
    if (w.fates[k] != FrameFate::kStays) continue;
    w.frames[kept] = w.frames[k];
    w.preintegrations[kept++] = w.preintegrations[k];
  }
  w.frames.resize(kept);
  w.preintegrations.resize(kept);
  w.ForgetSamples();

  // Tracks that ended before they became landmarks, and landmarks with too little left.
  for (std::size_t l = w.num_landmarks; l-- > 0;) {
    WindowLandmark& landmark = w.landmarks[l];
    int in_graph = 0;
    for (const LandmarkObservation& o : landmark.observations)
      in_graph += o.edge.slot != kNullSlot ? 1 : 0;
    if (landmark.InGraph() && in_graph < w.options.min_observations) {
      if (Status s = w.RemoveFromGraph(&landmark); !s.ok()) return s;
      w.Count(WindowEvent::kLandmarkStarved);
    }
    const bool ended = landmark.NewestFrame() != w.frames.back().id;
    if (landmark.observations.empty() || (ended && !landmark.InGraph())) w.ForgetLandmark(l);
  }
  return {};
}

}  // namespace glissade
