// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include "glissade/edges/reprojection_xyz.h"
#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "glissade/problem/problem.h"
#include "window/init_scene.h"

namespace glissade::internal {

namespace {

/// 0.1 % of chi2 with 2 degrees of freedom, and some more as poses are not exact yet.
constexpr double kMaxSightChi2 = 16.0;

EdgeReprojectionXYZ EdgeOf(const Scene& scene, const Sight& sight) {
  EdgeReprojectionXYZ edge;
  edge.uv = sight.xy;
  edge.T_b_c = scene.cameras[sight.camera].T_r_c;
  return edge;
}

/// Chi2 of a sight of a point; infinite behind the camera.
double Chi2(const Scene& scene, const Sight& sight, const Vector3& point) {
  const RigCamera& camera = scene.cameras[sight.camera];
  const Vector3 c = (scene.poses[sight.frame] * camera.T_r_c).Inverse() * point;
  if (!(c[2] > 0.0)) return std::numeric_limits<double>::infinity();
  const Vector2 r = camera.whitening * (Vector2(c[0] / c[2], c[1] / c[2]) - sight.xy);
  return r.squaredNorm();
}

SolveOptions Coarse(int iterations) {
  SolveOptions options;
  options.max_iterations = iterations;
  options.cost_tolerance = 1e-4;
  return options;
}

}  // namespace

FrameFit LocateFrame(std::size_t frame, Scene* scene) {
  const auto in_frame = [&](const Sight& sight) { return sight.frame == frame && !sight.bad; };
  std::vector<const SightedTrack*> seen;
  for (const SightedTrack& track : scene->tracks) {
    if (track.has_point && std::any_of(track.sights.begin(), track.sights.end(), in_frame)) {
      seen.push_back(&track);
    }
  }
  const int tracks = static_cast<int>(seen.size());
  FrameFit fit;
  fit.needed = std::max(kMinTracks, (tracks + 2) / 3);
  if (tracks < kMinTracks) return {tracks, fit.needed};
  Problem problem;
  const auto pose = problem.AddVertex(VertexPose{scene->poses[frame]});
  std::vector<EdgeHandle<EdgeReprojectionXYZ>> edges;
  // What is found here is the start of an adjustment: so many will do.
  constexpr std::size_t kEnough = 60;
  const std::size_t stride = (seen.size() + kEnough - 1) / kEnough;
  for (std::size_t j = 0; j < seen.size(); j += stride) {
    const auto point = problem.AddVertex(VertexPointXYZ(seen[j]->point));
    problem.SetFixed(point.value());
    for (const Sight& sight : seen[j]->sights) {
      if (!in_frame(sight)) continue;
      EdgeOptions<EdgeReprojectionXYZ> options;
      options.sqrt_information = scene->cameras[sight.camera].whitening;
      options.loss = Huber{3.0};
      edges.push_back(problem.AddEdge(EdgeOf(*scene, sight), {pose, point}, options).value());
    }
  }
  // Far from the start a loss that forgets what does not fit would forget all.
  if (!problem.Solve(Coarse(4)).ok()) return fit;
  for (const auto& edge : edges)
    problem.SetLoss(edge, Cauchy{2.0});
  if (!problem.Solve(Coarse(8)).ok()) return fit;
  scene->poses[frame] = problem.Get(pose).pose;
  for (const SightedTrack* track : seen) {
    const auto sight = std::find_if(track->sights.begin(), track->sights.end(), in_frame);
    // Points of the scene so far are not exact, and so neither is this.
    if (Chi2(*scene, *sight, track->point) < 4.0 * kMaxSightChi2) ++fit.tracks;
  }
  scene->located[frame] = fit.tracks >= fit.needed;
  return fit;
}

Status AdjustScene(std::size_t fixed, std::size_t second, int iterations, Scene* scene) {
  Problem problem;
  std::vector<VertexHandle<VertexPose>> poses(scene->poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (scene->located[k]) poses[k] = problem.AddVertex(VertexPose{scene->poses[k]});
  }
  std::vector<VertexHandle<VertexPointXYZ>> points(scene->tracks.size());
  for (std::size_t j = 0; j < points.size(); ++j) {
    const SightedTrack& track = scene->tracks[j];
    if (!track.has_point) continue;
    points[j] = problem.AddVertex(VertexPointXYZ(track.point));
    for (const Sight& sight : track.sights) {
      if (sight.bad || !scene->located[sight.frame]) continue;
      EdgeOptions<EdgeReprojectionXYZ> options;
      options.sqrt_information = scene->cameras[sight.camera].whitening;
      options.loss = Cauchy{2.0};
      const auto edge =
          problem.AddEdge(EdgeOf(*scene, sight), {poses[sight.frame], points[j]}, options);
      if (!edge.ok()) return edge.status();
    }
  }
  SolveOptions options = Coarse(iterations);
  if (scene->stereo) {
    problem.SetFixed(poses[fixed]);
  } else {
    options.gauge = Gauge::Fixed{.anchor = poses[fixed], .second = poses[second]};
  }
  const SolveSummary& summary = problem.Solve(options);
  if (!summary.ok()) return summary.status;

  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (scene->located[k]) scene->poses[k] = problem.Get(poses[k]).pose;
  }
  for (std::size_t j = 0; j < points.size(); ++j) {
    SightedTrack& track = scene->tracks[j];
    if (!track.has_point) continue;
    track.point = problem.Get(points[j]).p();
    int good = 0;
    for (Sight& sight : track.sights) {
      if (!scene->located[sight.frame]) continue;
      sight.bad = !(Chi2(*scene, sight, track.point) < kMaxSightChi2);
      if (!sight.bad) ++good;
    }
    track.has_point = good >= 2;
  }
  return {};
}

}  // namespace glissade::internal
