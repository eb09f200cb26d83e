// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/ideal_tracks.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace glissade::app {

namespace {

constexpr std::uint64_t kTrackStream = 304;
constexpr double kBorderPx = 3.0;
constexpr double kNearestM = 0.1;

struct Sight {
  float o[3], d[3];
};

Sight SightTo(const Pose& T_s_c, const Vector3& direction_s) {
  Sight sight;
  for (int k = 0; k < 3; ++k) {
    sight.o[k] = static_cast<float>(T_s_c.p()[k]);
    sight.d[k] = static_cast<float>(direction_s[k]);
  }
  return sight;
}

}  // namespace

IdealTracks::IdealTracks(const IdealTrackOptions& options, std::vector<vision::Camera> cameras)
    : options_(options), cameras_(std::move(cameras)), random_(options.seed, kTrackStream) {}

std::optional<Vector2> IdealTracks::See(const Scene& scene, const vision::Camera& camera,
                                        const Pose& T_s_c, const Vector3& p_s) const {
  const Vector3 p_c = T_s_c.Inverse() * p_s;
  if (!(p_c[2] > kNearestM)) return {};
  const double xy[2] = {p_c[0] / p_c[2], p_c[1] / p_c[2]};
  double uv[2], back[2];
  if (!camera.Distort(xy, uv)) return {};
  if (!(uv[0] >= kBorderPx && uv[0] <= camera.width - 1 - kBorderPx && uv[1] >= kBorderPx &&
        uv[1] <= camera.height - 1 - kBorderPx)) {
    return {};
  }
  // A polynomial comes back into the image with rays from far outside.
  if (!camera.Undistort(uv, back) || std::hypot(back[0] - xy[0], back[1] - xy[1]) > 1e-6) return {};
  const Sight sight = SightTo(T_s_c, p_s - T_s_c.p());
  if (scene.Cast(sight.o, sight.d).t < 0.995f) return {};  // something is in between
  return Vector2(uv[0], uv[1]);
}

void IdealTracks::Record(const vision::Camera& camera, const Vector2& uv,
                         ViotracksObservation observation,
                         std::vector<ViotracksObservation>* tracks) {
  const double noisy[2] = {uv[0] + random_.Normal(options_.noise_px),
                           uv[1] + random_.Normal(options_.noise_px)};
  double xy[2];
  if (!camera.Undistort(noisy, xy)) return;
  const CameraPinhole& pinhole = camera.pinhole();
  observation.u = pinhole.fx * xy[0] + pinhole.cx;
  observation.v = pinhole.fy * xy[1] + pinhole.cy;
  tracks->push_back(observation);
}

void IdealTracks::Observe(const Scene& scene, const Pose& T_s_b, std::int32_t frame,
                          std::vector<ViotracksObservation>* tracks) {
  const vision::Camera& first = cameras_[0];
  const Pose T_s_c = T_s_b * first.T_b_c;
  const int columns = (first.width + options_.cell_px - 1) / options_.cell_px;
  const int rows = (first.height + options_.cell_px - 1) / options_.cell_px;
  std::vector<char> taken(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  const auto cell_of = [&](const Vector2& uv) {
    const int x = static_cast<int>(uv[0]) / options_.cell_px;
    const int y = static_cast<int>(uv[1]) / options_.cell_px;
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(x);
  };
  std::vector<std::pair<Track, Vector2>> seen;
  for (const Track& track : tracks_) {
    const auto uv = See(scene, first, T_s_c, track.p_s);
    const bool lost = random_.Uniform(0.0, 1.0) * options_.age_frames < 1.0;
    if (!uv || lost) continue;
    taken[cell_of(*uv)] = 1;
    seen.emplace_back(track, *uv);
  }
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const double u = (x + random_.Uniform(0.0, 1.0)) * options_.cell_px;
      const double v = (y + random_.Uniform(0.0, 1.0)) * options_.cell_px;
      const double uv[2] = {u, v};
      double xy[2];
      if (u > first.width - 1 || v > first.height - 1 || taken[cell_of({u, v})] != 0 ||
          !first.Undistort(uv, xy)) {
        continue;
      }
      const Vector3 ray_s = T_s_c.R() * Vector3(xy[0], xy[1], 1.0);
      const Sight sight = SightTo(T_s_c, ray_s);
      const Vector3 p_s = T_s_c.p() + static_cast<double>(scene.Cast(sight.o, sight.d).t) * ray_s;
      if (const auto there = See(scene, first, T_s_c, p_s)) {
        seen.emplace_back(Track{next_id_++, p_s}, *there);
      }
    }
  }
  tracks_.clear();
  for (const auto& [track, uv] : seen) {
    tracks_.push_back(track);
    Record(first, uv, {.frame = frame, .track = track.id, .camera = 0, .u = 0.0, .v = 0.0}, tracks);
  }
  for (std::size_t k = 1; k < cameras_.size(); ++k) {
    const Pose T_s_other = T_s_b * cameras_[k].T_b_c;
    for (const Track& track : tracks_) {
      const auto uv = See(scene, cameras_[k], T_s_other, track.p_s);
      if (!uv) continue;
      Record(cameras_[k], *uv,
             {.frame = frame,
              .track = track.id,
              .camera = static_cast<std::int32_t>(k),
              .u = 0.0,
              .v = 0.0},
             tracks);
    }
  }
}

Viotracks PerfectTracks(const IdealTrackOptions& options, const vision::ImageRecording& recording,
                        const Scene& scene, const Vector3& gravity) {
  constexpr double kLeastSigmaPx = 0.01;  // an observation without any has no weight
  Viotracks tracks;
  tracks.origin = "perfect tracks of images rendered by glissade (sim_images), seed " +
                  std::to_string(options.seed);
  tracks.gravity = gravity;
  for (const vision::Camera& camera : recording.cameras) {
    const CameraPinhole& f = camera.pinhole();
    tracks.cameras.push_back({f.fx, f.fy, f.cx, f.cy, camera.width, camera.height,
                              std::max(options.noise_px, kLeastSigmaPx), camera.T_b_c});
  }
  tracks.imu_noise = recording.imu_noise;
  tracks.imu_rate_hz = recording.imu_rate_hz;
  tracks.imu = recording.imu;
  tracks.ground_truth = recording.ground_truth;
  IdealTracks tracker(options, recording.cameras);
  for (std::size_t k = 0; k < recording.frames.size(); ++k) {
    const auto frame = static_cast<std::int32_t>(k);
    tracks.frames.push_back({frame, recording.frames[k].stamp_ns});
    tracker.Observe(scene, scene.ToScene(recording.ground_truth[k].T_w_b), frame, &tracks.tracks);
  }
  return tracks;
}

}  // namespace glissade::app
