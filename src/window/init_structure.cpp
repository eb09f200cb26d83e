// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/init_structure.h"

#include <algorithm>
#include <cmath>

#include "window/init_two_view.h"
#include "window/quantiles.h"
#include "window/verdicts.h"

namespace glissade::internal {

namespace {

/// R of rig k + 1 in rig k.
Matrix3 PredictedRotation(const ImuPreintegration& term, const Pose& T_b_r) {
  const Matrix3 R_b_r = T_b_r.R();
  return R_b_r.transpose() * RotationMatrix(term.imu.dq.coeffs().data()) * R_b_r;
}

/// Tracks of the frame that have no point yet; or all: a point from its first two views is as wrong
/// as these are close to each other.
void TriangulateSeen(std::size_t frame, bool all, Scene* scene) {
  for (SightedTrack& track : scene->tracks) {
    if (track.has_point && !all) continue;
    const bool seen = std::any_of(track.sights.begin(), track.sights.end(),
                                  [&](const Sight& s) { return s.frame == frame; });
    if (seen) Triangulate(*scene, &track);
  }
}

int CountPoints(const Scene& scene) {
  return static_cast<int>(std::count_if(scene.tracks.begin(), scene.tracks.end(),
                                        [](const SightedTrack& t) { return t.has_point; }));
}

InitVerdict Lost(int fit, int needed = kMinTracks) {
  return Refusal(InitReason::kTooFewTracks, fit, needed, "number of tracks that fit a frame", "");
}

InitVerdict NotSolved(const Status& status) {
  return {InitReason::kNotConverged, 0.0, 0.0, status.message()};
}

/// A bundle adjustment of all that can have a point.
InitVerdict Finish(std::size_t fixed, std::size_t second, Scene* scene) {
  for (SightedTrack& track : scene->tracks) {
    if (!track.has_point) Triangulate(*scene, &track);
  }
  if (Status s = AdjustScene(fixed, second, 15, scene); !s.ok()) return NotSolved(s);
  const int points = CountPoints(*scene);
  return points < kMinTracks ? Lost(points) : InitVerdict();
}

}  // namespace

double MedianDepth(const Scene& scene) {
  std::vector<double> depths;
  for (const SightedTrack& track : scene.tracks) {
    if (!track.has_point) continue;
    for (const Sight& sight : track.sights) {
      if (!sight.bad && scene.located[sight.frame]) {
        depths.push_back((track.point - scene.poses[sight.frame].p()).norm());
        break;
      }
    }
  }
  if (depths.empty()) return 1.0;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

InitVerdict LocateWithStereo(const std::vector<ImuPreintegration>& terms, Scene* scene) {
  scene->poses[0] = Pose();
  scene->located[0] = 1;
  TriangulateSeen(0, false, scene);
  for (std::size_t k = 1; k < scene->poses.size(); ++k) {
    const Pose& last = scene->poses[k - 1];
    Pose& pose = scene->poses[k];
    pose = Pose(Matrix3(last.R() * PredictedRotation(terms[k - 1], scene->T_b_r)), last.p());
    if (k >= 2) pose.p() += last.p() - scene->poses[k - 2].p();
    const FrameFit fit = LocateFrame(k, scene);
    if (!scene->located[k]) return Lost(fit.tracks, fit.needed);
    TriangulateSeen(k, k % 3 == 2, scene);
  }
  return Finish(0, 0, scene);
}

namespace {

/// Tracks that are seen in both frames.
std::vector<Match> MatchesOf(const Scene& scene, std::size_t i, std::size_t j) {
  std::vector<Match> matches;
  for (const SightedTrack& track : scene.tracks) {
    const Sight *a = nullptr, *b = nullptr;
    for (const Sight& sight : track.sights) {
      if (sight.frame == i) a = &sight;
      if (sight.frame == j) b = &sight;
    }
    if (a && b) matches.push_back({a->xy, b->xy});
  }
  return matches;
}

struct Pair {
  std::size_t i = 0, j = 0;
  std::vector<Match> matches;
  Pose T_j_i;  ///< only the rotation, by the gyroscope
  double seconds = 0.0;
  RotationFit rotation;
  double score = 0.0;
};

/// The pair, with the first or the last frame in it, that has many tracks and much parallax.
Pair BestPair(const std::vector<ImuPreintegration>& terms, double sigma, const Scene& scene) {
  Pair best;
  const std::size_t last = scene.poses.size() - 1;
  const auto consider = [&](std::size_t i, std::size_t j) {
    Pair pair;
    pair.i = i;
    pair.j = j;
    pair.matches = MatchesOf(scene, i, j);
    if (pair.matches.size() < static_cast<std::size_t>(kMinTracks)) return;
    Matrix3 R_i_j = Matrix3::Identity();
    for (std::size_t k = i; k < j; ++k) {
      R_i_j = R_i_j * PredictedRotation(terms[k], scene.T_b_r);
      pair.seconds += terms[k].imu.dt;
    }
    pair.T_j_i = Pose(Matrix3(R_i_j.transpose()), Vector3::Zero());
    pair.rotation = FitRotation(pair.matches, sigma, pair.T_j_i);
    // Parallax beyond twenty sigma does not make two views much better, nor tracks beyond fifty.
    pair.score = std::min(pair.rotation.median, 20.0) *
                 std::sqrt(std::min(static_cast<double>(pair.matches.size()), 50.0));
    if (pair.score > best.score) best = std::move(pair);
  };
  for (std::size_t k = 2; k <= last; ++k)
    consider(0, k);
  for (std::size_t k = 1; k + 2 <= last; ++k)
    consider(k, last);
  return best;
}

/// Locates a frame from its neighbours: rotation by the gyroscope from the nearest one that is
/// located, position on the line between two of them, or on from the last.
void LocateFromNeighbours(std::size_t frame, const std::vector<ImuPreintegration>& terms,
                          Scene* scene) {
  const std::size_t count = scene->poses.size();
  std::size_t before = frame, after = frame;
  while (before > 0 && !scene->located[before])
    --before;
  while (after + 1 < count && !scene->located[after])
    ++after;
  const bool has_before = scene->located[before], has_after = scene->located[after];
  if (!has_before && !has_after) return;
  Matrix3 R;
  Vector3 p;
  if (has_before) {
    R = scene->poses[before].R();
    for (std::size_t k = before; k < frame; ++k)
      R = R * PredictedRotation(terms[k], scene->T_b_r);
    p = scene->poses[before].p();
    if (has_after) {
      const double share =
          static_cast<double>(frame - before) / static_cast<double>(after - before);
      p += share * (scene->poses[after].p() - p);
    } else if (before > 0 && scene->located[before - 1]) {
      p += p - scene->poses[before - 1].p();
    }
  } else {
    R = scene->poses[after].R();
    for (std::size_t k = after; k > frame; --k)
      R = R * PredictedRotation(terms[k - 1], scene->T_b_r).transpose();
    p = scene->poses[after].p();
    if (after + 1 < count && scene->located[after + 1]) p += p - scene->poses[after + 1].p();
  }
  scene->poses[frame] = Pose(R, p);
  LocateFrame(frame, scene);
  if (scene->located[frame]) TriangulateSeen(frame, false, scene);
}

}  // namespace

InitVerdict LocateWithOneCamera(const std::vector<ImuPreintegration>& terms, double gyro_sigma,
                                double false_alarm, Scene* scene) {
  const double sigma = scene->cameras[0].sigma.maxCoeff();
  const Pair pair = BestPair(terms, sigma, *scene);
  const int count = static_cast<int>(pair.matches.size());
  if (count < kMinTracks) {
    return Refusal(InitReason::kTooFewTracks, count, kMinTracks,
                   "number of tracks seen in two frames apart", "");
  }
  // Half of the tracks are over the median; a few lead elsewhere. Whether what is left is enough,
  // the covariance of the refinement will tell.
  const double p = 0.53;
  const double most = count * p + NormalQuantile(false_alarm) * std::sqrt(count * p * (1.0 - p));
  if (pair.rotation.moved <= std::min(most, count - 1.0)) {
    return Refusal(InitReason::kRotationOnly, pair.rotation.moved, most,
                   "number of tracks that a rotation does not explain", "");
  }
  const double max_angle = std::min(0.1 + 3.0 * gyro_sigma * pair.seconds, 3.2);
  const RelativePose relative = FindRelativePose(pair.matches, sigma, pair.T_j_i, max_angle);
  if (!relative.ok) return Lost(relative.inliers);
  scene->poses[pair.i] = Pose();
  scene->poses[pair.j] =
      Pose(Matrix3(relative.R_b_a.transpose()), -relative.R_b_a.transpose() * relative.t);
  scene->located[pair.i] = scene->located[pair.j] = 1;
  for (SightedTrack& track : scene->tracks)
    Triangulate(*scene, &track);
  if (CountPoints(*scene) < kMinTracks) return Lost(CountPoints(*scene));
  if (Status s = AdjustScene(pair.i, pair.j, 10, scene); !s.ok()) return NotSolved(s);

  const std::size_t frames = scene->poses.size();
  for (int round = 0; round < 2; ++round) {
    for (std::size_t k = pair.i + 1; k < frames; ++k) {
      if (!scene->located[k]) LocateFromNeighbours(k, terms, scene);
    }
    for (std::size_t k = pair.i; k-- > 0;) {
      if (!scene->located[k]) LocateFromNeighbours(k, terms, scene);
    }
  }
  const auto located = std::count(scene->located.begin(), scene->located.end(), char{1});
  if (located < static_cast<std::ptrdiff_t>(frames)) {
    return Refusal(InitReason::kTooFewTracks, static_cast<double>(located),
                   static_cast<double>(frames), "number of frames that could be located", "");
  }
  return Finish(pair.i, pair.j, scene);
}

}  // namespace glissade::internal
