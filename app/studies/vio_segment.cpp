// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/vio_segment.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "glissade/imu/buffer.h"
#include "glissade/sim/noise_source.h"

namespace glissade::app {

namespace {

using sim::ViObservation;
using sim::ViProblem;
using Track = std::vector<ViObservation>;

Status Refused(const std::string& why) {
  return {StatusCode::kInvalidArgument, "segment: " + why};
}

/// Camera of an observation, world to camera, with the true poses.
Pose CameraOf(const ViProblem& problem, const ViObservation& o) {
  const auto k = static_cast<std::size_t>(o.keyframe), c = static_cast<std::size_t>(o.camera);
  return (problem.truth.poses[k].pose * problem.cameras[c].T_b_c).Inverse();
}

/// Distance of the projection of X from what was observed (px); infinity behind the camera.
double ErrorOf(const ViProblem& problem, const ViObservation& o, const Vector3& X) {
  const sim::ViCamera& c = problem.cameras[static_cast<std::size_t>(o.camera)];
  const Vector3 x = CameraOf(problem, o) * X;
  if (!(x[2] > 0.05)) return std::numeric_limits<double>::infinity();
  return std::hypot(c.fx * x[0] / x[2] + c.cx - o.u, c.fy * x[1] / x[2] + c.cy - o.v);
}

/// Linear triangulation (Hartley, Zisserman, Sec. 12.2) from all rays.
Vector3 Triangulate(const ViProblem& problem, const Track& track) {
  Eigen::Matrix4d AtA = Eigen::Matrix4d::Zero();
  for (const ViObservation& o : track) {
    const sim::ViCamera& c = problem.cameras[static_cast<std::size_t>(o.camera)];
    const Pose T = CameraOf(problem, o);
    Eigen::Matrix<double, 3, 4> P;
    P << Eigen::Matrix3d(T.R()), Eigen::Vector3d(T.p());
    const Eigen::RowVector4d a = (o.u - c.cx) / c.fx * P.row(2) - P.row(0);
    const Eigen::RowVector4d b = (o.v - c.cy) / c.fy * P.row(2) - P.row(1);
    AtA += a.transpose() * a + b.transpose() * b;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(AtA);
  const Eigen::Vector4d X = eigen.eigenvectors().col(0);
  return Vector3(X.head<3>() / X[3]);
}

/// Triangulates and throws out the worst observation until all fit. Fewer than six (from three
/// keyframes, say, by two cameras) are no track.
bool Clean(const ViProblem& problem, double max_error_px, Track* track, Vector3* X) {
  while (track->size() >= 6) {
    *X = Triangulate(problem, *track);
    std::size_t worst = 0;
    double most = -1.0;
    for (std::size_t k = 0; k < track->size(); ++k) {
      const double error = ErrorOf(problem, (*track)[k], *X);
      if (!(error <= most)) {
        most = error;
        worst = k;
      }
    }
    if (most <= max_error_px) return true;
    track->erase(track->begin() + static_cast<std::ptrdiff_t>(worst));
  }
  return false;
}

Status AddKeyframes(const Viotracks& recording, const VioSegmentOptions& options,
                    ViProblem* problem, std::map<std::int32_t, std::int32_t>* keyframe_of) {
  std::map<std::int64_t, const GroundTruthState*> truth;
  for (const GroundTruthState& state : recording.ground_truth)
    truth[state.stamp_ns] = &state;
  if (recording.frames.empty()) return Refused("the recording has no frames");
  const std::int64_t first = recording.frames.front().stamp_ns;
  const double length_s = 1e-9 * static_cast<double>(recording.frames.back().stamp_ns - first);
  // Before it becomes nanoseconds: not every number of seconds does.
  if (!(options.start_s >= 0.0 && options.start_s <= length_s)) {
    return Refused(fmt::format("must begin from 0 to {:g} s after the first frame, not at {:g} s",
                               length_s, options.start_s));
  }
  const std::int64_t begin = first + static_cast<std::int64_t>(1e9 * options.start_s);
  std::size_t frame = 0;
  while (frame < recording.frames.size() && recording.frames[frame].stamp_ns < begin)
    ++frame;
  for (int k = 0; k < options.num_keyframes;
       ++k, frame += static_cast<std::size_t>(options.frame_step)) {
    if (frame >= recording.frames.size()) return Refused("the recording is too short");
    const std::int64_t stamp = recording.frames[frame].stamp_ns;
    const auto state = truth.find(stamp);
    if (state == truth.end() || !state->second->speed_bias) {
      return Refused("there are no true pose, velocity and biases of frame " +
                     std::to_string(recording.frames[frame].id));
    }
    (*keyframe_of)[static_cast<std::int32_t>(frame)] = k;
    problem->stamps_ns.push_back(stamp);
    problem->truth.poses.push_back({state->second->T_w_b});
    problem->truth.speed_biases.push_back(*state->second->speed_bias);
  }
  return {};
}

Status AddImu(const Viotracks& recording, ViProblem* problem) {
  ImuBuffer buffer;
  for (const ImuSample& sample : recording.imu)
    (void)buffer.Add(sample);  // what does not fit is left out
  ImuInterval interval;
  for (std::size_t k = 0; k + 1 < problem->stamps_ns.size(); ++k) {
    const VertexSpeedBias& at = problem->truth.speed_biases[k];
    if (Status s = buffer.Between(problem->stamps_ns[k], problem->stamps_ns[k + 1], &interval);
        !s.ok()) {
      return s;
    }
    const auto preintegration =
        Preintegrate(interval.samples, {at.ba(), at.bg()}, *recording.imu_noise);
    if (!preintegration.ok()) return preintegration.status();
    auto factor = MakeImuFactor(*preintegration);
    if (!factor.ok()) return factor.status();
    factor->edge.gravity = recording.gravity;
    problem->imu.push_back(*factor);
  }
  return {};
}

void AddTracks(const Viotracks& recording, const VioSegmentOptions& options,
               const std::map<std::int32_t, std::int32_t>& keyframe_of, ViProblem* problem) {
  std::map<std::int32_t, Track> tracks;
  for (const ViotracksObservation& o : recording.tracks) {
    const auto keyframe = keyframe_of.find(o.frame);
    if (keyframe == keyframe_of.end()) continue;
    tracks[o.track].push_back({keyframe->second, 0, o.camera, o.u, o.v});
  }
  std::vector<std::pair<Track, Vector3>> clean;
  for (auto& [id, track] : tracks) {
    Vector3 X;
    if (Clean(*problem, options.max_error_px, &track, &X)) clean.emplace_back(std::move(track), X);
  }
  std::stable_sort(clean.begin(), clean.end(),
                   [](const auto& a, const auto& b) { return a.first.size() > b.first.size(); });
  if (clean.size() > static_cast<std::size_t>(options.num_points)) {
    clean.resize(static_cast<std::size_t>(options.num_points));
  }
  for (auto& [track, X] : clean) {
    for (ViObservation& o : track) {
      o.point = static_cast<std::int32_t>(problem->truth.points.size());
      problem->observations.push_back(o);
    }
    problem->truth.points.emplace_back(X);
  }
}

}  // namespace

Result<ViProblem> MakeVioSegment(const Viotracks& recording, const VioSegmentOptions& options) {
  if (!recording.imu_noise) return Refused("the recording has no IMU");
  if (options.num_keyframes < 2 || options.frame_step < 1) {
    return Refused("needs at least two keyframes, one frame apart");
  }
  ViProblem problem;
  for (const ViotracksCamera& c : recording.cameras) {
    problem.cameras.push_back({c.fx, c.fy, c.cx, c.cy, c.width, c.height, c.sigma_px, c.T_b_c});
  }
  std::map<std::int32_t, std::int32_t> keyframe_of;
  if (Status s = AddKeyframes(recording, options, &problem, &keyframe_of); !s.ok()) return s;
  if (Status s = AddImu(recording, &problem); !s.ok()) return s;
  AddTracks(recording, options, keyframe_of, &problem);
  if (problem.truth.points.empty()) return Refused("there are no tracks");
  problem.start = problem.truth;
  return problem;
}

ViProblem WithStart(const ViProblem& segment, const VioStartOptions& options, std::uint64_t seed) {
  sim::NoiseSource random(seed, 12);
  ViProblem problem = segment;
  const double angle = std::numbers::pi / 180.0 * options.rotation_deg;
  for (std::size_t k = 0; k < problem.start.poses.size(); ++k) {
    const Vector3 dp = options.position_m * random.Direction();
    const Vector3 dtheta = angle * random.Direction();
    const double delta[6] = {dp[0], dp[1], dp[2], dtheta[0], dtheta[1], dtheta[2]};
    problem.start.poses[k].Plus(delta);
    problem.start.speed_biases[k].v() += random.Uniform3(options.velocity_mps);
  }
  for (auto& point : problem.start.points)
    point.p() += random.Uniform3(options.point_m);
  return problem;
}

}  // namespace glissade::app
