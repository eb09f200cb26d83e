// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "common/interrupt.h"
#include "glissade/edges/imu.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/imu/buffer.h"
#include "glissade/imu/imu_factor.h"
#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "glissade/problem/problem.h"

namespace glissade::app {

namespace {

/// An observation of a track by a frame of the batch.
struct Sight {
  std::size_t frame = 0;  // in the batch
  int camera = 0;
  Vector2 uv = Vector2::Zero();
};
using Track = std::vector<Sight>;

struct State {
  std::int64_t stamp_ns = 0;
  VertexPose pose;
  VertexSpeedBias speed_bias;
};

struct Round {
  double max_chi2 = 0.0;  ///< of a view of a triangulated point
  Loss loss;
  int max_iterations = 0;
};

class Batch {
 public:
  Batch(const Viotracks& recording, const ReplaySettings& settings, SlidingWindowOptions options,
        const CausalRun& causal)
      : recording_(recording), options_(std::move(options)) {
    for (const FrameEstimate& estimate : causal.estimates) {
      batch_frame_[estimate.frame] = states_.size();
      states_.push_back(
          {estimate.state.stamp_ns, VertexPose{estimate.state.T_w_b}, estimate.state.speed_bias});
    }
    CollectTracks(settings, causal);
  }

  Status Solve(const Round& round) {
    Problem problem;
    std::vector<VertexHandle<VertexPose>> poses;
    std::vector<VertexHandle<VertexSpeedBias>> speed_biases;
    for (const State& state : states_) {
      poses.push_back(problem.AddVertex(state.pose));
      if (options_.imu_noise) speed_biases.push_back(problem.AddVertex(state.speed_bias));
    }
    if (options_.imu_noise) {
      if (Status s = AddImu(poses, speed_biases, &problem); !s.ok()) return s;
    }
    if (Status s = AddPoints(poses, round, &problem); !s.ok()) return s;
    SolveOptions options;
    options.max_iterations = round.max_iterations;
    options.cost_tolerance = 1e-7;
    options.gauge = Gauge::Fixed{
        .anchor = poses.front(),
        .reference = {},
        .second = {},
        .group = options_.imu_noise ? GaugeGroup::kVisualInertial : GaugeGroup::kStereo};
    StopWhenInterrupted(&options);
    const SolveSummary& summary = problem.Solve(options);
    if (!summary.ok()) return summary.status;
    solution_.iterations += summary.accepted_steps + summary.rejected_steps;
    solution_.final_cost = summary.final_cost;
    solution_.time_s += summary.time.total_s;
    for (std::size_t k = 0; k < states_.size(); ++k) {
      states_[k].pose = problem.Get(poses[k]);
      if (options_.imu_noise) states_[k].speed_bias = problem.Get(speed_biases[k]);
    }
    return {};
  }

  BatchSolution Finish() {
    for (const State& state : states_)
      solution_.trajectory.push_back({state.stamp_ns, state.pose.pose});
    return std::move(solution_);
  }

 private:
  void CollectTracks(const ReplaySettings& settings, const CausalRun& causal) {
    FaultyReplay replay(
        recording_,
        {.num_cameras = options_.cameras.size(), .time_offset_s = settings.time_offset_s},
        settings.faults);
    std::map<ObservationKey, Vector2> seen;  // a duplicate frame counts once
    while (const Delivery* delivery = replay.Next()) {
      const auto frame = batch_frame_.find(delivery->frame);
      if (frame == batch_frame_.end()) continue;
      for (const FrameObservation& o : delivery->observations) {
        const ObservationKey key{o.track, delivery->frame, o.camera};
        if (!std::isfinite(o.u + o.v)) continue;
        if (std::binary_search(causal.rejected_keys.begin(), causal.rejected_keys.end(), key)) {
          ++rejected_;
          continue;
        }
        seen.try_emplace(key,
                         options_.cameras[static_cast<std::size_t>(o.camera)].Normalized(o.u, o.v));
      }
    }
    std::int64_t track = -1;
    for (const auto& [key, uv] : seen) {
      if (tracks_.empty() || key.track != track) tracks_.emplace_back();
      track = key.track;
      tracks_.back().push_back({batch_frame_.at(key.frame), key.camera, uv});
    }
  }

  Status AddImu(const std::vector<VertexHandle<VertexPose>>& poses,
                const std::vector<VertexHandle<VertexSpeedBias>>& speed_biases, Problem* problem) {
    ImuBuffer buffer;
    for (const ImuSample& sample : recording_.imu)
      static_cast<void>(buffer.Add(sample));  // what does not fit is left out
    ImuInterval interval;
    solution_.imu_terms = 0;
    for (std::size_t k = 0; k + 1 < states_.size(); ++k) {
      if (Status s = buffer.Between(states_[k].stamp_ns, states_[k + 1].stamp_ns, &interval);
          !s.ok()) {
        return s;
      }
      const VertexSpeedBias& at = states_[k].speed_bias;
      const auto integral = Preintegrate(interval.samples, {at.ba(), at.bg()}, *options_.imu_noise);
      if (!integral.ok()) return integral.status();
      auto factor = MakeImuFactor(*integral);
      if (!factor.ok()) return factor.status();
      factor->edge.gravity = Vector3(0.0, 0.0, -options_.gravity);
      const auto edge = problem->AddEdge(
          factor->edge, {poses[k], speed_biases[k], poses[k + 1], speed_biases[k + 1]},
          factor->options);
      if (!edge.ok()) return edge.status();
      ++solution_.imu_terms;
    }
    return {};
  }

  double Chi2(const Sight& sight, const Vector3& X) const {
    const WindowCamera& camera = options_.cameras[static_cast<std::size_t>(sight.camera)];
    const Pose T_w_c = states_[sight.frame].pose.pose * camera.T_b_c;
    const Vector3 x = T_w_c.R().transpose() * (X - T_w_c.p());
    if (!(x[2] > options_.triangulation.min_depth)) {
      return std::numeric_limits<double>::infinity();
    }
    const double du = camera.fx / camera.sigma_px * (x[0] / x[2] - sight.uv[0]);
    const double dv = camera.fy / camera.sigma_px * (x[1] / x[2] - sight.uv[1]);
    return du * du + dv * dv;
  }

  /// The point of a track, and the track without views that do not fit, worst first; null: none.
  std::optional<Vector3> Clean(Track* track, double max_chi2) const {
    TriangulationOptions options = options_.triangulation;
    options.max_chi2 = 1e12;  // which view is wrong is found out here
    std::vector<TriangulationView> views;
    while (track->size() >= 3) {
      views.clear();
      for (const Sight& sight : *track) {
        const WindowCamera& camera = options_.cameras[static_cast<std::size_t>(sight.camera)];
        views.push_back({states_[sight.frame].pose.pose * camera.T_b_c, sight.uv,
                         camera.sigma_px / std::sqrt(camera.fx * camera.fy)});
      }
      const auto point = Triangulate(views, options);
      if (!point.ok()) return {};
      std::size_t worst = 0;
      double most = -1.0;
      for (std::size_t k = 0; k < track->size(); ++k) {
        const double chi2 = Chi2((*track)[k], point->X_w);
        if (!(chi2 <= most)) {
          most = chi2;
          worst = k;
        }
      }
      if (most <= max_chi2) return point->X_w;
      track->erase(track->begin() + static_cast<std::ptrdiff_t>(worst));
    }
    return {};
  }

  Status AddPoints(const std::vector<VertexHandle<VertexPose>>& poses, const Round& round,
                   Problem* problem) {
    solution_.points = solution_.observations = 0;
    solution_.left_out = rejected_;
    for (const Track& whole : tracks_) {
      Track track = whole;
      const auto X = Clean(&track, round.max_chi2);
      solution_.left_out += static_cast<int>(whole.size() - (X ? track.size() : 0));
      if (!X) continue;
      const auto point = problem->AddVertex(VertexPointXYZ{*X});
      if (!point.ok()) return point.status();
      ++solution_.points;
      for (const Sight& sight : track) {
        const WindowCamera& camera = options_.cameras[static_cast<std::size_t>(sight.camera)];
        EdgeReprojectionXYZ edge;
        edge.uv = sight.uv;
        edge.T_b_c = camera.T_b_c;
        const Matrix2 per_sigma =
            Vector2(camera.fx / camera.sigma_px, camera.fy / camera.sigma_px).asDiagonal();
        const auto added = problem->AddEdge(edge, {poses[sight.frame], *point},
                                            {.sqrt_information = per_sigma, .loss = round.loss});
        if (!added.ok()) return added.status();
        ++solution_.observations;
      }
    }
    return {};
  }

  const Viotracks& recording_;
  SlidingWindowOptions options_;
  std::map<std::size_t, std::size_t> batch_frame_;  // of a frame of the recording
  std::vector<State> states_;
  std::vector<Track> tracks_;
  int rejected_ = 0;
  BatchSolution solution_;
};

}  // namespace

Result<BatchSolution> SolveBatch(const Viotracks& recording, const ReplaySettings& settings,
                                 const CausalRun& causal) {
  if (causal.estimates.size() < 2) {
    return Status(StatusCode::kInvalidArgument, "--batch: the window has fewer than two states");
  }
  auto options = WindowOptions(recording, settings);
  if (!options.ok()) return options.status();
  const Viotracks faulty = WithImuFaults(recording, settings.faults);
  const double gate = options->max_chi2;
  Batch batch(faulty, settings, std::move(options).value(), causal);
  // Poses that drift by many pixels over a long track first; then what is left is noise.
  if (Status s = batch.Solve({.max_chi2 = 1e3, .loss = Cauchy{2.0}, .max_iterations = 30});
      !s.ok()) {
    return s;
  }
  if (Status s = batch.Solve({.max_chi2 = gate, .loss = Huber{3.0}, .max_iterations = 30});
      !s.ok()) {
    return s;
  }
  return batch.Finish();
}

}  // namespace glissade::app
