// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A body that stands still measures its velocity, zero, and that it is where it was.
#include <algorithm>
#include <iterator>

#include "glissade/base/index.h"
#include "glissade/base/validate.h"
#include "glissade/edges/body_velocity.h"
#include "glissade/edges/relative_pose.h"
#include "glissade/window/stillness.h"
#include "window/sliding_window_impl.h"

namespace glissade {

using internal::Index;

namespace {

/// What standing still is judged by, and how long what was seen is remembered.
constexpr std::int64_t kJudgedNs = 600'000'000;
constexpr std::int64_t kRememberedNs = 5'000'000'000;

/// Sigma of the angle by which a body stands still that shows no tremble (rad): it is rigid. Not
/// what the test of stillness allows: each frame's attitude would then scatter by what the images
/// leave open, and a window takes scatter for motion. Motion tells the tilt from the bias of the
/// accelerometer, and the tilt would follow the walk of that bias, by a degree in ten minutes.
constexpr double kRigidAngle = 1e-6;

double AngleToExpect(const StillnessTest& test) {
  return std::max(2.0 * test.tremble_angle, kRigidAngle);
}

}  // namespace

void SlidingWindow::Impl::Remember(std::int64_t stamp_ns,
                                   std::span<const FrameObservation> observations) {
  // The frames that are too old give their storage to the new one.
  const auto old = std::find_if(seen.begin(), seen.end(), [&](const SeenFrame& frame) {
    return frame.stamp_ns >= stamp_ns ||
           SecondsBetween(frame.stamp_ns, stamp_ns) <= 1e-9 * static_cast<double>(kRememberedNs);
  });
  if (old == seen.begin()) {
    seen.emplace_back();
  } else {
    const auto too_old = static_cast<std::size_t>(old - seen.begin());
    std::rotate(seen.begin(), old, seen.end());
    seen.resize(seen.size() - too_old + 1);
  }
  seen.back().stamp_ns = stamp_ns;
  // As much as any has had, so that storage that is handed on is soon enough for each.
  most_seen = std::max(most_seen, observations.size());
  seen.back().observations.reserve(most_seen);
  std::vector<FrameObservation>& kept = seen.back().observations;
  kept.clear();
  std::copy_if(observations.begin(), observations.end(), std::back_inserter(kept),
               [&](const FrameObservation& o) { return MakesSense(o); });
}

bool SlidingWindow::Impl::MakesSense(const FrameObservation& o) const {
  const double uv[2] = {o.u, o.v};
  return o.camera >= 0 && Index(o.camera) < options.cameras.size() && internal::AllFinite(uv, 2);
}

std::span<const FrameObservations> SlidingWindow::Impl::SeenSince(std::int64_t stamp_ns) {
  seen_views.clear();
  for (const SeenFrame& frame : seen) {
    if (frame.stamp_ns >= stamp_ns) seen_views.push_back({frame.stamp_ns, frame.observations});
  }
  return seen_views;
}

bool SlidingWindow::Impl::StandsStill(std::int64_t stamp_ns) {
  if (!imu.Between(stamp_ns - kJudgedNs, stamp_ns, &interval).ok()) return false;
  const StillnessTest test = internal::TestStillness(interval.samples, *options.imu_noise,
                                                     options.stillness, internal::Words::kNone);
  if (!test.verdict.ok()) return false;
  standing_angle = std::min(AngleToExpect(test), options.stillness.tremble_angle);
  return image_stillness
      .Test(options.cameras, SeenSince(stamp_ns - kJudgedNs), options.stillness,
            internal::Words::kNone)
      .verdict.ok();
}

/// Whether the newest images are those of the frame where standing began, so far as both see the
/// same landmarks: what creeps is not seen in half a second.
bool SlidingWindow::Impl::StandsWhereItBegan(std::int64_t anchor_id) {
  anchor_seen.clear();
  newest_seen.clear();
  const auto pixels = [&](const WindowLandmark& landmark, const LandmarkObservation& o) {
    const WindowCamera& c = options.cameras[Index(o.camera)];
    return FrameObservation{landmark.track, o.camera, c.fx * o.uv[0] + c.cx, c.fy * o.uv[1] + c.cy};
  };
  const WindowFrame& anchor = frames[Index(FrameIndex(anchor_id))];
  const WindowFrame& frame = frames.back();
  for (const WindowLandmark& landmark : Landmarks()) {
    for (const LandmarkObservation& o : landmark.observations) {
      if (o.frame == anchor_id) anchor_seen.push_back(pixels(landmark, o));
      if (o.frame == frame.id) newest_seen.push_back(pixels(landmark, o));
    }
  }
  const FrameObservations both[2] = {{anchor.stamp_ns, anchor_seen}, {frame.stamp_ns, newest_seen}};
  return image_stillness.Test(options.cameras, both, options.stillness, internal::Words::kNone)
             .verdict.reason != InitReason::kMoving;
}

Status SlidingWindow::UseStillness() {
  Impl& w = impl();
  if (w.frames.empty() || !w.HasImu() || !w.options.use_stillness) return {};
  const WindowFrame& frame = w.frames.back();
  if (!frame.HasSpeedBias() || !w.StandsStill(frame.stamp_ns)) {
    w.anchor_frame = -1;
    return {};
  }
  w.Count(WindowEvent::kStandingStill);
  const double per_speed = 1.0 / w.options.stillness.tremble_speed;
  const auto still =
      w.problem.AddEdge(EdgeBodyVelocity{}, {frame.pose, frame.speed_bias},
                        {.sqrt_information = Matrix3(per_speed * Matrix3::Identity())});
  if (!still.ok()) {
    static_cast<void>(w.problem.AcknowledgeRefusal());
    return still.status();
  }
  const int anchor = w.anchor_frame >= 0 ? w.FrameIndex(w.anchor_frame) : -1;
  if (anchor < 0 || !w.StandsWhereItBegan(w.anchor_frame)) {
    w.anchor_frame = frame.id;
    return {};
  }
  // A tremble of that speed at some ten hertz is one of a millimetre.
  Vector6 per_sigma;
  per_sigma.head<3>().setConstant(1.0 / (0.1 * w.options.stillness.tremble_speed));
  per_sigma.tail<3>().setConstant(1.0 / w.standing_angle);
  const auto same_place =
      w.problem.AddEdge(EdgeRelativePose{}, {w.frames[Index(anchor)].pose, frame.pose},
                        {.sqrt_information = Matrix6(per_sigma.asDiagonal())});
  if (!same_place.ok()) {
    static_cast<void>(w.problem.AcknowledgeRefusal());
    return same_place.status();
  }
  return {};
}

}  // namespace glissade
