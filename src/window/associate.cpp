// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Book-keeping of tracks: which landmark a feature shows, and when its point is known.
#include <algorithm>
#include <cmath>
#include <utility>

#include "glissade/base/index.h"
#include "window/sliding_window_impl.h"
#include "window/triangulate.h"

namespace glissade {

using internal::Index;

WindowLandmark& SlidingWindow::Impl::LandmarkOf(std::int64_t track) {
  const int found = tracks.Find(track);
  if (found >= 0) return landmarks[Index(found)];
  if (num_landmarks == landmarks.size()) landmarks.emplace_back();
  tracks.Set(track, static_cast<int>(num_landmarks));
  WindowLandmark& landmark = landmarks[num_landmarks++];
  landmark.track = track;
  landmark.point = {};
  landmark.observations.clear();
  landmark.observations.reserve(most_observations);
  return landmark;
}

void SlidingWindow::Impl::ForgetLandmark(std::size_t index) {
  tracks.Erase(landmarks[index].track);
  const std::size_t last = --num_landmarks;
  if (index == last) return;
  std::swap(landmarks[index], landmarks[last]);
  tracks.Set(landmarks[index].track, static_cast<int>(index));
}

Status SlidingWindow::Impl::RemoveFromGraph(WindowLandmark* landmark) {
  if (Status s = problem.RemoveVertex(landmark->point); !s.ok()) return s;
  for (LandmarkObservation& o : landmark->observations) {
    if (o.edge.slot == kNullSlot) continue;
    o.edge = {};
    const int frame = FrameIndex(o.frame);
    if (frame >= 0) --frames[Index(frame)].num_observations;
  }
  landmark->point = {};
  return {};
}

Status SlidingWindow::Impl::AddObservationEdge(WindowLandmark* landmark,
                                               LandmarkObservation* observation) {
  const WindowCamera& camera = options.cameras[Index(observation->camera)];
  WindowFrame& frame = frames[Index(FrameIndex(observation->frame))];
  EdgeReprojectionXYZ edge;
  edge.uv = observation->uv;
  edge.T_b_c = camera.T_b_c;
  EdgeOptions<EdgeReprojectionXYZ> weight;
  weight.sqrt_information =
      Matrix2(Vector2(camera.fx / camera.sigma_px, camera.fy / camera.sigma_px).asDiagonal());
  weight.loss = options.loss;
  const auto added = problem.AddEdge(edge, {frame.pose, landmark->point}, weight);
  if (!added.ok()) {
    static_cast<void>(problem.AcknowledgeRefusal());
    return added.status();
  }
  observation->edge = *added;
  ++frame.num_observations;
  return {};
}

bool SlidingWindow::Impl::IsPredictionTrusted() const {
  constexpr double kMaxSecondsAlone = 1.0;
  if (!HasImu() || frames.size() < 2 || preintegrations.back().gaps.count > 0) return false;
  for (std::size_t k = frames.size() - 1; k-- > 0;) {
    if (frames[k].num_observations == 0) continue;
    return SecondsBetween(frames[k].stamp_ns, frames.back().stamp_ns) <= kMaxSecondsAlone;
  }
  return false;
}

bool SlidingWindow::Impl::IsNearPrediction(const WindowLandmark& landmark,
                                           const LandmarkObservation& o) const {
  if (predicted_cameras.empty()) return true;
  return predicted_cameras[Index(o.camera)].SquareInSigmas(problem.Get(landmark.point).p(), o) <=
         options.max_prediction_error * options.max_prediction_error;
}

Status SlidingWindow::Associate(std::span<const FrameObservation> observations) {
  Impl& w = impl();
  if (w.frames.empty()) return {StatusCode::kInvalidArgument, "the window has no state yet"};
  const WindowFrame& frame = w.frames.back();
  w.seen_by_camera.assign(w.options.cameras.size(), 0);
  w.predicted_cameras.clear();
  if (w.IsPredictionTrusted()) {
    for (const WindowCamera& camera : w.options.cameras)
      w.predicted_cameras.emplace_back(camera, frame.T_w_b);
  }
  for (const FrameObservation& o : observations) {
    if (!w.MakesSense(o)) {
      w.Count(WindowEvent::kObservationRefused);
      continue;
    }
    WindowLandmark& landmark = w.LandmarkOf(o.track);
    const auto same = [&](const LandmarkObservation& x) {
      return x.frame == frame.id && x.camera == o.camera;
    };
    if (std::any_of(landmark.observations.rbegin(), landmark.observations.rend(), same)) {
      w.Count(WindowEvent::kObservationRefused);
      continue;
    }
    LandmarkObservation observation;
    observation.frame = frame.id;
    observation.camera = o.camera;
    observation.uv = w.options.cameras[Index(o.camera)].Normalized(o.u, o.v);
    ++w.seen_by_camera[Index(o.camera)];
    if (landmark.InGraph() && !w.IsNearPrediction(landmark, observation)) {
      w.Count(WindowEvent::kObservationRejected);
      continue;
    }
    landmark.observations.push_back(observation);
    w.most_observations = std::max(w.most_observations, landmark.observations.size());
    if (!landmark.InGraph()) continue;
    if (Status s = w.AddObservationEdge(&landmark, &landmark.observations.back()); !s.ok()) {
      landmark.observations.pop_back();
      w.Count(WindowEvent::kObservationRefused);
    }
  }
  const auto silent = std::count(w.seen_by_camera.begin(), w.seen_by_camera.end(), 0);
  if (Index(silent) < w.seen_by_camera.size()) {
    w.Count(WindowEvent::kCameraWithoutFeatures, silent);
  }
  return {};
}

void SlidingWindow::Impl::UpdateCamerasInWorld() {
  cameras_in_world.clear();
  for (const WindowFrame& frame : frames) {
    for (const WindowCamera& camera : options.cameras)
      cameras_in_world.emplace_back(camera, frame.T_w_b);
  }
}

Status SlidingWindow::TriangulateTracks() {
  Impl& w = impl();
  if (w.frames.empty()) return {StatusCode::kInvalidArgument, "the window has no state yet"};
  w.UpdateCamerasInWorld();
  const std::int64_t newest = w.frames.back().id;
  for (WindowLandmark& landmark : w.Landmarks()) {
    if (landmark.InGraph() || landmark.NewestFrame() != newest ||
        landmark.observations.size() < 2) {
      continue;
    }
    w.views.clear();
    for (const LandmarkObservation& o : landmark.observations) {
      const WindowCamera& camera = w.options.cameras[Index(o.camera)];
      w.views.push_back({w.CameraOf(w.FrameIndex(o.frame), o.camera).T_w_c, o.uv,
                         camera.sigma_px / std::sqrt(camera.fx * camera.fy)});
    }
    TriangulatedPoint point;
    const StatusCode code =
        internal::TryToTriangulate(w.views, w.options.triangulation, &point).code;
    if (code != StatusCode::kOk) {
      if (code == StatusCode::kEvaluationFailed) {
        // One of the views is wrong, and nobody knows which: begin anew with the newest frame's.
        std::erase_if(landmark.observations,
                      [&](const LandmarkObservation& o) { return o.frame != newest; });
        w.Count(WindowEvent::kObservationRejected);
      }
      continue;
    }
    const auto vertex = w.problem.AddVertex(VertexPointXYZ{point.X_w});
    if (!vertex.ok()) {
      static_cast<void>(w.problem.AcknowledgeRefusal());
      return vertex.status();
    }
    landmark.point = *vertex;
    for (LandmarkObservation& o : landmark.observations) {
      if (Status s = w.AddObservationEdge(&landmark, &o); !s.ok()) return s;
    }
    w.Count(WindowEvent::kLandmarkTriangulated);
  }
  if (w.frames.back().num_observations == 0) w.Count(WindowEvent::kFrameWithoutLandmarks);
  return {};
}

void SlidingWindow::ChooseKeyframe(KeyframeChoice choice) {
  Impl& w = impl();
  if (w.frames.empty()) return;
  WindowFrame& frame = w.frames.back();
  const auto before = std::find_if(w.frames.rbegin() + 1, w.frames.rend(),
                                   [](const WindowFrame& f) { return f.is_keyframe; });
  if (choice != KeyframeChoice::kByRules) {
    frame.is_keyframe = choice == KeyframeChoice::kYes;
  } else if (before == w.frames.rend() || !w.HasImu()) {
    // Without an IMU nothing but its observations ties a frame to the others, and those of a frame
    // that is no keyframe are lost.
    frame.is_keyframe = true;
  } else if (w.anchor_frame >= 0) {
    // Standing still shows nothing new, and the frame where it began is to stay.
    frame.is_keyframe = w.anchor_frame == frame.id;
  } else {
    const KeyframeRules& rules = w.options.keyframes;
    const Matrix3 R_last_new = before->T_w_b.R().transpose() * frame.T_w_b.R();
    int seen = 0, common = 0;
    double parallax = 0.0;
    for (const WindowLandmark& landmark : w.Landmarks()) {
      if (landmark.NewestFrame() != frame.id) continue;
      const LandmarkObservation& now = landmark.observations.back();
      ++seen;
      const auto then = std::find_if(landmark.observations.begin(), landmark.observations.end(),
                                     [&](const LandmarkObservation& o) {
                                       return o.frame == before->id && o.camera == now.camera;
                                     });
      if (then == landmark.observations.end()) continue;
      ++common;
      const Matrix3 R_b_c = w.options.cameras[Index(now.camera)].T_b_c.R();
      const Vector3 ray =
          R_b_c.transpose() * (R_last_new * (R_b_c * Vector3(now.uv[0], now.uv[1], 1.0)));
      if (ray[2] > 0.1) {
        parallax += Vector2(ray[0] / ray[2] - then->uv[0], ray[1] / ray[2] - then->uv[1]).norm();
      }
    }
    frame.is_keyframe =
        static_cast<double>(common) < rules.min_tracked_share * static_cast<double>(seen) ||
        parallax > rules.max_parallax * static_cast<double>(common) ||
        SecondsBetween(before->stamp_ns, frame.stamp_ns) > rules.max_interval_s;
  }
  if (frame.is_keyframe) w.Count(WindowEvent::kKeyframe);
}

}  // namespace glissade
