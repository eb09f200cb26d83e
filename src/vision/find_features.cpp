// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "vision/tracker_impl.h"

namespace glissade::vision {

using internal::Stopwatch;
using internal::Tracked;

void FeatureTracker::Impl::DetectCorners() {
  const Stopwatch watch(&report.detect_ms);
  const int missing = options.max_features - static_cast<int>(tracks.size());
  if (missing <= 0) return;
  points.clear();
  for (const Tracked& t : tracks)
    points.push_back(t.px);
  std::vector<cv::Point2f> corners;
  detector.Detect(now, points, options, missing, &corners);
  for (const cv::Point2f& px : corners) {
    Tracked t;
    if (!MakeTracked(px, &t)) continue;
    t.track = next_track++;
    // A corner is where it is found, to a pixel of the half image at worst: what it is followed to
    // is the patch around it, not the corner.
    t.sigma_px = internal::kGreySigma / (options.window_px * std::sqrt(options.min_corner));
    tracks.push_back(t);
    ++report.detected;
  }
}

void FeatureTracker::Impl::MatchSecondCamera(const ImageView& image) {
  const Stopwatch watch(&report.stereo_ms);
  if (image.empty() || internal::GreyValuesOf(image).deviation < options.min_contrast ||
      IsRepeated(image, &last_raw[1])) {
    Raise(TrackerEvent::kSecondCameraLost);
    return;
  }
  makers[1].Make(image, &second);
  points.clear();
  guesses.clear();
  std::vector<std::size_t> of;
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    Tracked& t = tracks[k];
    cv::Point2f guess;
    double inverse_depth = 0.0;
    if (t.inverse_depth && stereo->Project(t.xy, *t.inverse_depth, &guess)) {
    } else if (!stereo->Search(now, second, t.px, t.xy, &guess, &inverse_depth)) {
      continue;
    }
    points.push_back(t.px);
    guesses.push_back(guess);
    of.push_back(k);
  }
  internal::TrackThereAndBack(now, second, points, guesses, options, 1, &lk);
  for (Tracked& t : tracks)
    t.inverse_depth.reset();
  const CameraPinhole& pinhole = cameras[1].pinhole();
  const double tolerance = options.max_stereo_epipolar_px / (0.5 * (pinhole.fx + pinhole.fy));
  for (std::size_t i = 0; i < of.size(); ++i) {
    Tracked& t = tracks[of[i]];
    const double uv[2] = {static_cast<double>(lk.points[i].x), static_cast<double>(lk.points[i].y)};
    double xy[2];
    if (lk.found[i] == 0 || !cameras[1].Undistort(uv, xy)) continue;
    const double rho = stereo->InverseDepth(t.xy, xy);
    // A little beyond infinity is what noise makes of far points.
    const double beyond = -2.0 * tolerance / stereo->baseline();
    if (stereo->Distance(t.xy, xy) > tolerance || !(rho < 1.0 / options.min_depth_m) ||
        rho < std::min(beyond, -1e-3)) {
      ++report.rejected;
      continue;
    }
    t.inverse_depth = std::max(0.0, rho);
    Feature& f = features.emplace_back();
    f.track = t.track;
    f.camera = 1;
    f.px = {uv[0], uv[1]};
    f.xy = {xy[0], xy[1]};
    f.age = t.age;
    f.sigma_px = std::hypot(t.sigma_px, 0.5 * static_cast<double>(lk.back_px[i]));
    ++report.stereo;
  }
  if (report.stereo == 0 && tracks.size() >= 20) Raise(TrackerEvent::kSecondCameraLost);
}

}  // namespace glissade::vision
