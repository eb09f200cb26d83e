// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "vision/epipolar.h"
#include "vision/tracker_impl.h"

namespace glissade::vision {

using internal::Stopwatch;
using internal::Tracked;

namespace {

// A gyroscope whose bias nobody has estimated: so wrong is a rate, sigma (rad/s).
constexpr double kBiasSigma = 0.1;

}  // namespace

void FeatureTracker::Impl::FollowFeatures() {
  const std::optional<Matrix3> turn = CameraTurn();
  std::vector<Tracked> found;
  {
    const Stopwatch watch(&report.track_ms);
    points.clear();
    guesses.clear();
    for (const Tracked& t : tracks) {
      points.push_back(t.px);
      guesses.push_back(t.px);
      if (!turn) continue;
      const Vector3 f = turn->transpose() * Vector3(t.xy[0], t.xy[1], 1.0);
      const double xy[2] = {f[0] / f[2], f[1] / f[2]};
      double uv[2];
      if (f[2] > 0.0 && cameras[0].Distort(xy, uv)) {
        guesses.back() = cv::Point2f(static_cast<float>(uv[0]), static_cast<float>(uv[1]));
      }
    }
    internal::TrackThereAndBack(reference, now, points, guesses, options,
                                turn ? options.levels_predicted : options.levels_blind, &lk);
    for (std::size_t k = 0; k < tracks.size(); ++k) {
      Tracked t = tracks[k];
      if (lk.found[k] == 0 || !MakeTracked(lk.points[k], &t)) continue;
      const double gradient = static_cast<double>(lk.gradient[k]);
      const double window = options.window_px;
      const double of_noise = internal::kGreySigma / (window * std::sqrt(std::max(1e-3, gradient)));
      t.sigma_px = std::hypot(of_noise, 0.5 * static_cast<double>(lk.back_px[k]));
      ++t.age;
      found.push_back(t);
    }
  }
  report.lost = static_cast<int>(tracks.size() - found.size());
  const std::vector<Tracked> before = std::move(tracks);
  RejectOutliers(before, &found);
  report.tracked = static_cast<int>(found.size());
  tracks = std::move(found);
  if (before.size() < 20 || 3 * tracks.size() >= before.size()) return;
  Raise(TrackerEvent::kImageBlurred);
  if (SecondsBetween(reference_ns, now_ns) > options.max_blind_s) {
    Raise(TrackerEvent::kTracksLost);
    return;
  }
  // What was found is told, but looked for from the last good image again.
  Publish(tracks);
  tracks = before;
}

void FeatureTracker::Impl::RejectOutliers(const std::vector<Tracked>& before,
                                          std::vector<Tracked>* found) {
  const Stopwatch watch(&report.reject_ms);
  const std::optional<Matrix3> turn = CameraTurn();
  std::vector<internal::Match> matches;
  auto old = before.begin();
  for (const Tracked& t : *found) {
    while (old->track != t.track)
      ++old;
    matches.push_back({{old->xy[0], old->xy[1]}, {t.xy[0], t.xy[1]}});
  }
  const CameraPinhole& pinhole = cameras[0].pinhole();
  const double tolerance = options.max_epipolar_px / (0.5 * (pinhole.fx + pinhole.fy));
  std::vector<unsigned char> fits;
  if (turn) {
    internal::TwoViews views;
    views.R_a_b = *turn;
    const double seconds = SecondsBetween(reference_ns, now_ns);
    internal::FitMatches(matches, std::max(1e-4, kBiasSigma * seconds), tolerance, &views, &fits);
  } else {
    internal::FitMatchesBlind(matches, tolerance, &fits);
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < found->size(); ++k)
    if (fits[k] != 0) (*found)[kept++] = (*found)[k];
  report.rejected = static_cast<int>(found->size() - kept);
  found->resize(kept);
}

}  // namespace glissade::vision
