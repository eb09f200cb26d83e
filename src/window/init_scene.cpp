// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/init_scene.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "glissade/base/validate.h"

namespace glissade::internal {

namespace {

struct Row {
  std::int64_t track;
  std::size_t frame, camera;
  Vector2 xy;
};

std::vector<Row> SortedRows(const InitializationInput& input) {
  std::vector<Row> rows;
  for (std::size_t k = 0; k < input.frames.size(); ++k) {
    for (const FrameObservation& o : input.frames[k].observations) {
      const auto camera = static_cast<std::size_t>(o.camera);
      const Vector2 xy = input.cameras[camera].Normalized(o.u, o.v);
      if (AllFinite(xy.data(), 2)) rows.push_back({o.track, k, camera, xy});
    }
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return std::tie(a.track, a.frame, a.camera) < std::tie(b.track, b.frame, b.camera);
  });
  return rows;
}

bool SameTrackAndFrame(const Row& a, const Row& b) {
  return a.track == b.track && a.frame == b.frame;
}

}  // namespace

Scene CollectScene(const InitializationInput& input) {
  std::vector<Row> rows = SortedRows(input);
  // The same camera twice: the first counts.
  rows.erase(std::unique(rows.begin(), rows.end(),
                         [](const Row& a, const Row& b) {
                           return SameTrackAndFrame(a, b) && a.camera == b.camera;
                         }),
             rows.end());
  Scene scene;
  std::vector<int> by_camera(input.cameras.size(), 0);
  int pairs = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ++by_camera[rows[k].camera];
    if (k > 0 && SameTrackAndFrame(rows[k], rows[k - 1])) ++pairs;
  }
  scene.stereo = pairs >= kMinTracks * static_cast<int>(input.frames.size());
  const auto most = static_cast<std::size_t>(std::max_element(by_camera.begin(), by_camera.end()) -
                                             by_camera.begin());
  for (std::size_t c = 0; c < input.cameras.size(); ++c) {
    if (!scene.stereo && c != most) continue;
    const WindowCamera& camera = input.cameras[c];
    RigCamera in_rig;
    if (scene.stereo) in_rig.T_r_c = camera.T_b_c;
    in_rig.sigma = Vector2(camera.sigma_px / camera.fx, camera.sigma_px / camera.fy);
    in_rig.whitening = in_rig.sigma.cwiseInverse().asDiagonal();
    scene.cameras.push_back(in_rig);
  }
  if (!scene.stereo && !input.cameras.empty()) scene.T_b_r = input.cameras[most].T_b_c;
  scene.poses.resize(input.frames.size());
  scene.located.assign(input.frames.size(), 0);

  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin;
    SightedTrack track;
    track.id = rows[begin].track;
    for (; end < rows.size() && rows[end].track == track.id; ++end) {
      if (!scene.stereo && rows[end].camera != most) continue;
      track.sights.push_back(
          {rows[end].frame, scene.stereo ? rows[end].camera : 0, rows[end].xy, false});
    }
    begin = end;
    if (track.sights.size() >= 2) scene.tracks.push_back(std::move(track));
  }
  return scene;
}

Ray RayOf(const Scene& scene, const Sight& sight) {
  const Pose T_v_c = scene.poses[sight.frame] * scene.cameras[sight.camera].T_r_c;
  return {T_v_c.p(), T_v_c.R() * Vector3(sight.xy[0], sight.xy[1], 1.0)};
}

namespace {

/// The point that is nearest to the rays of all good sights; false where there are fewer than two.
bool NearestToRays(const Scene& scene, const SightedTrack& track, Eigen::Vector3d* x) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Sight& sight : track.sights) {
    if (sight.bad || !scene.located[sight.frame]) continue;
    const Ray ray = RayOf(scene, sight);
    const Eigen::Vector3d d = ray.direction.normalized();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose();
    A += across;
    b += across * ray.centre;
    ++count;
  }
  *x = A.ldlt().solve(b);
  return count >= 2 && AllFinite(x->data(), 3);
}

/// Normal equations of all good sights at a point.
struct PointFit {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero(), axis = Eigen::Vector3d::Zero();
  double chi2 = 0.0, depth = 0.0, worst_chi2 = 0.0;
  int count = 0;
  const Sight* worst = nullptr;
  bool in_front = true;

  PointFit(const Scene& scene, const Eigen::Vector3d& x, const SightedTrack& track) {
    for (const Sight& sight : track.sights) {
      if (sight.bad || !scene.located[sight.frame]) continue;
      const RigCamera& camera = scene.cameras[sight.camera];
      const Pose T_v_c = scene.poses[sight.frame] * camera.T_r_c;
      const Eigen::Matrix3d R = T_v_c.R();
      const Eigen::Vector3d c = R.transpose() * (x - T_v_c.p());
      in_front = in_front && c[2] > 0.0;
      Eigen::Matrix<double, 2, 3> J;
      J << 1.0 / c[2], 0.0, -c[0] / (c[2] * c[2]), 0.0, 1.0 / c[2], -c[1] / (c[2] * c[2]);
      J = camera.sigma.cwiseInverse().asDiagonal() * J * R.transpose();
      const Eigen::Vector2d r =
          (Eigen::Vector2d(c[0] / c[2], c[1] / c[2]) - sight.xy).cwiseQuotient(camera.sigma);
      H.noalias() += J.transpose() * J;
      g.noalias() += J.transpose() * r;
      chi2 += r.squaredNorm();
      if (!(r.squaredNorm() <= worst_chi2)) {
        worst_chi2 = r.squaredNorm();
        worst = &sight;
      }
      depth = c[2];
      axis = R.col(2);
      ++count;
    }
  }
  /// Its depth in the last camera has a sigma of less than half of itself.
  [[nodiscard]] bool Determined() const {
    const double variance = axis.dot(H.ldlt().solve(axis));
    return variance > 0.0 && variance < 0.25 * depth * depth;
  }
};

}  // namespace

bool IsDetermined(const Scene& scene, const SightedTrack& track) {
  const PointFit fit(scene, track.point, track);
  return fit.in_front && fit.Determined();
}

double VisionChi2(const Scene& scene) {
  double chi2 = 0.0;
  for (const SightedTrack& track : scene.tracks) {
    if (track.has_point) chi2 += PointFit(scene, track.point, track).chi2;
  }
  return chi2;
}

bool Triangulate(const Scene& scene, SightedTrack* track) {
  constexpr int kMostBad = 4;
  track->has_point = false;
  std::array<Sight*, kMostBad> left_out = {};
  for (int attempt = 0;; ++attempt) {
    Eigen::Vector3d x;
    if (!NearestToRays(scene, *track, &x)) break;
    for (int iteration = 0; iteration < 3; ++iteration) {
      const PointFit fit(scene, x, *track);
      const Eigen::Vector3d step = fit.H.ldlt().solve(fit.g);
      if (!fit.in_front || !AllFinite(step.data(), 3)) break;
      x -= step;
    }
    const PointFit fit(scene, x, *track);
    if (fit.in_front && fit.chi2 < 9.0 * fit.count && fit.worst_chi2 < 100.0) {
      if (!fit.Determined()) break;
      track->point = x;
      track->has_point = true;
      return true;
    }
    // The one that fits least is the likeliest to be wrong.
    if (attempt == kMostBad || fit.worst == nullptr || fit.count <= 3) break;
    Sight& worst = track->sights[static_cast<std::size_t>(fit.worst - track->sights.data())];
    worst.bad = true;
    left_out[static_cast<std::size_t>(attempt)] = &worst;
  }
  for (Sight* sight : left_out) {
    if (sight) sight->bad = false;
  }
  return false;
}

}  // namespace glissade::internal
