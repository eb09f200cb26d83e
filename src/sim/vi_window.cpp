// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/vi_window.h"

#include <algorithm>

#include "glissade/edges/speed_bias_prior.h"
#include "glissade/sim/noise_source.h"

namespace glissade::sim {

namespace {
constexpr std::uint64_t kCalibration = 20;  // stream of a seed
}  // namespace

ViWindow::ViWindow(const ViProblem* problem, const ViWindowOptions& options, Graph* graph)
    : problem_(*problem), options_(options), graph_(*graph) {
  observations_.resize(problem_.stamps_ns.size());
  for (const ViObservation& o : problem_.observations)
    observations_[static_cast<std::size_t>(o.keyframe)].push_back(&o);
  tracks_.resize(problem_.start.points.size());
}

Status ViWindow::AddKeyframe() {
  const std::size_t k = next_;
  if (k >= problem_.stamps_ns.size()) {
    return {StatusCode::kInvalidArgument, "ViWindow: there are no more keyframes"};
  }
  VertexPose pose = problem_.start.poses[k];
  VertexSpeedBias speed_bias = problem_.start.speed_biases[k];
  if (k >= static_cast<std::size_t>(options_.initial_keyframes) && !keyframes_.empty()) {
    const Keyframe& last = keyframes_.back();
    const ImuPrediction predicted =
        Predict(problem_.imu[k - 1].edge, graph_.Get(last.pose), graph_.Get(last.speed_bias));
    pose = predicted.pose;
    speed_bias = predicted.speed_bias;
  }
  Keyframe frame;
  frame.number = k;
  const auto added_pose = graph_.AddVertex(pose);
  if (!added_pose.ok()) return added_pose.status();
  const auto added_speed = graph_.AddVertex(speed_bias);
  if (!added_speed.ok()) return added_speed.status();
  frame.pose = added_pose.value();
  frame.speed_bias = added_speed.value();
  if (k == 0) {
    if (Status s = AddFirst(frame); !s.ok()) return s;
  } else if (!keyframes_.empty()) {
    const ImuFactor& imu = problem_.imu[k - 1];
    const Keyframe& last = keyframes_.back();
    const auto added = graph_.AddEdge(
        imu.edge, {last.pose, last.speed_bias, frame.pose, frame.speed_bias}, imu.options);
    if (!added.ok()) return added.status();
  }
  if (Status s = AddObservations(pose, &frame); !s.ok()) return s;
  keyframes_.push_back(std::move(frame));
  ++next_;
  return {};
}

Status ViWindow::AddFirst(const Keyframe& frame) {
  NoiseSource random(options_.seed, kCalibration);
  EdgeSpeedBiasPrior calibration;
  calibration.prior = graph_.Get(frame.speed_bias);
  const VertexSpeedBias& truth = problem_.truth.speed_biases[0];
  calibration.prior.ba() = truth.ba() + random.Normal3(options_.accel_bias_sigma);
  calibration.prior.bg() = truth.bg() + random.Normal3(options_.gyro_bias_sigma);
  if (Status s = graph_.Set(frame.speed_bias, calibration.prior); !s.ok()) return s;
  SquareMatrix<9> root = SquareMatrix<9>::Zero();  // of the velocity it says nothing
  for (int i = 0; i < 3; ++i) {
    root(3 + i, 3 + i) = 1.0 / options_.accel_bias_sigma;
    root(6 + i, 6 + i) = 1.0 / options_.gyro_bias_sigma;
  }
  return graph_.AddEdge(calibration, {frame.speed_bias}, {.sqrt_information = root}).status();
}

ViWindow::Point* ViWindow::Tracked(std::size_t point) {
  const std::optional<Track>& track = tracks_[point];
  if (!track || keyframes_.empty() || track->keyframe < keyframes_.front().number) return nullptr;
  Point& found = keyframes_[track->keyframe - keyframes_.front().number].points[track->index];
  return graph_.Contains(AnyVertex(found.vertex)) ? &found : nullptr;
}

Status ViWindow::AddObservations(const VertexPose& start, Keyframe* frame) {
  const auto length = static_cast<std::size_t>(std::max(1, options_.track_length));
  // Where points begin: in front of the keyframe as it is estimated.
  const Pose to_estimate = start.pose * problem_.truth.poses[frame->number].pose.Inverse();
  const bool initial = frame->number < static_cast<std::size_t>(options_.initial_keyframes);
  for (const ViObservation* o : observations_[frame->number]) {
    const auto p = static_cast<std::size_t>(o->point);
    // Tracks of different points end at different keyframes.
    Point* point = (frame->number + p) % length == 0 ? nullptr : Tracked(p);
    if (point == nullptr) {
      VertexPointXYZ value = problem_.start.points[p];
      if (!initial) value.p() = to_estimate * Vector3(value.p());
      const auto added = graph_.AddVertex(value);
      if (!added.ok()) return added.status();
      tracks_[p] = Track{frame->number, frame->points.size()};
      point = &frame->points.emplace_back(Point{added.value(), {}});
    }
    const ViCamera& camera = problem_.cameras[static_cast<std::size_t>(o->camera)];
    EdgeReprojectionXYZ edge;
    edge.T_b_c = camera.T_b_c;
    edge.uv = {(o->u - camera.cx) / camera.fx, (o->v - camera.cy) / camera.fy};
    Matrix2 root = Matrix2::Zero();
    root(0, 0) = camera.fx / camera.sigma_px;
    root(1, 1) = camera.fy / camera.sigma_px;
    const auto added =
        graph_.AddEdge(edge, {frame->pose, point->vertex}, {.sqrt_information = root});
    if (!added.ok()) return added.status();
    point->observations.push_back(added.value());
  }
  return {};
}

std::vector<AnyVertex> ViWindow::TakeOldest() {
  std::vector<AnyVertex> vertices;
  if (keyframes_.empty()) return vertices;
  const Keyframe& oldest = keyframes_.front();
  vertices = {oldest.pose, oldest.speed_bias};
  for (const Point& point : oldest.points) {
    if (graph_.Contains(AnyVertex(point.vertex))) vertices.emplace_back(point.vertex);
  }
  keyframes_.erase(keyframes_.begin());
  return vertices;
}

Result<int> ViWindow::RemovePointsBehind() {
  constexpr double kNearest = 0.1;  // m
  int removed = 0;
  for (const Keyframe& frame : keyframes_) {
    for (const Point& point : frame.points) {
      if (!graph_.Contains(AnyVertex(point.vertex))) continue;
      bool behind = false;
      for (const auto& observation : point.observations) {
        const Result<double> depth = graph_.DepthOf(observation);
        behind |= depth.ok() && depth.value() < kNearest;
      }
      if (!behind) continue;
      if (Status s = graph_.RemoveVertex(point.vertex); !s.ok()) return s;
      ++removed;
    }
  }
  return removed;
}

std::vector<VertexHandle<VertexPointXYZ>> ViWindow::PointsSeenOnce() const {
  std::vector<VertexHandle<VertexPointXYZ>> once;
  for (const Keyframe& frame : keyframes_) {
    for (const Point& point : frame.points) {
      if (point.observations.size() == 1 && graph_.Contains(AnyVertex(point.vertex))) {
        once.push_back(point.vertex);
      }
    }
  }
  return once;
}

}  // namespace glissade::sim
