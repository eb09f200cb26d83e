// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Tracks of one camera between two of its images: relative rotations, tracks that jump, noise.
#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "glissade/lie/so3.h"
#include "window/doctor.h"
#include "window/doctor_two_view.h"

namespace glissade::internal {

namespace {

/// Images this far apart: long enough to rotate, short enough for tracks to live.
constexpr double kInterval = 0.5;
/// More matches cost time and add little.
constexpr std::size_t kMatches = 150;

std::vector<TwoViewMatch> MatchesOf(const std::vector<DoctorFeature>& a,
                                    const std::vector<DoctorFeature>& b) {
  std::vector<TwoViewMatch> matches;
  auto j = b.begin();
  for (const DoctorFeature& i : a) {
    while (j != b.end() && j->track < i.track)
      ++j;
    if (j == b.end()) break;
    if (j->track == i.track) matches.push_back({i.x, i.y, j->x, j->y});
  }
  return SomeOf(matches, kMatches);
}

/// The frame to compare frame `from` with: the last one within the interval that shares enough
/// tracks with it, or else the next. 0 where there is none.
std::size_t Partner(const DoctorCase& c, std::size_t camera, std::size_t from,
                    std::vector<TwoViewMatch>* matches) {
  std::size_t to = from + 1;
  while (to + 1 < c.frames.size() && c.frames[to + 1].t - c.frames[from].t <= 1.2 * kInterval)
    ++to;
  for (; to > from; --to) {
    if (to >= c.frames.size()) continue;
    *matches = MatchesOf(c.frames[from].features[camera], c.frames[to].features[camera]);
    if (matches->size() >= 20 || (to == from + 1 && matches->size() >= 12)) return to;
  }
  return 0;
}

/// Over all pairs of one camera.
struct Totals {
  std::int64_t matches = 0, outliers = 0;
  std::vector<double> noise;
  double worst_share = 0.0;
  std::int64_t worst_stamp = 0;
  int pairs = 0, failed = 0;
};

void AddPair(std::size_t camera, std::size_t from, std::size_t to,
             const std::vector<TwoViewMatch>& matches, Totals* totals, DoctorCase* c) {
  const WindowCamera& k = c->input.cameras[camera];
  const TwoViewMotion motion = EstimateTwoView(matches, k.sigma_px / k.fx, k.sigma_px / k.fy,
                                               c->options.seed + 1000003 * from + camera);
  if (!motion.ok) {
    ++totals->failed;
    return;
  }
  ++totals->pairs;
  DoctorPair& pair = c->pairs.emplace_back();
  pair.camera = static_cast<int>(camera);
  pair.from = static_cast<int>(from);
  pair.to = static_cast<int>(to);
  pair.t0 = c->frames[from].t;
  pair.t1 = c->frames[to].t;
  // x1 ~ R' x2: the rotation of the second camera in the first.
  const Matrix3 R = motion.R.transpose();
  pair.phi = so3::Log(R);
  pair.covariance = R * motion.covariance * R.transpose();
  pair.matches = static_cast<int>(matches.size());
  pair.outliers = motion.outliers;
  pair.noise = motion.noise;
  pair.some = SomeOf(matches, 80);
  pair.t = motion.t;
  totals->matches += pair.matches;
  totals->outliers += pair.outliers;
  totals->noise.push_back(pair.noise);
  const double share = static_cast<double>(pair.outliers) / static_cast<double>(pair.matches);
  if (share > totals->worst_share) {
    totals->worst_share = share;
    totals->worst_stamp = c->frames[from].stamp_ns;
  }
}

void Report(std::size_t camera, Totals* totals, DoctorCase* c) {
  if (totals->pairs < 5) return;
  const double n = static_cast<double>(totals->matches);
  const double of_matches = static_cast<double>(totals->outliers) / n;
  // A match is bad where one of its two observations is.
  const double share = 1.0 - std::sqrt(1.0 - of_matches);
  const double sigma = 0.5 * std::sqrt(std::max(of_matches, 1.0 / n) / n);
  c->report.facts.outlier_share = std::max(c->report.facts.outlier_share, share);
  if (share > 0.03) {
    const DoctorSeverity severity = share > 0.2    ? DoctorSeverity::kError
                                    : share > 0.05 ? DoctorSeverity::kWarning
                                                   : DoctorSeverity::kInfo;
    DoctorFinding& f = c->Add(
        DoctorKind::kTrackJumps, severity, CameraName(camera),
        Text("%.3g %% of the observations are off their epipolar lines; worst %.0f %% of the "
             "tracks from one image to another",
             100.0 * share, 100.0 * totals->worst_share),
        "tracks that slide or jump: check them forward and backward, gate them; use a robust loss");
    f.stamp_ns = totals->worst_stamp;
    f.count = totals->outliers;
    f.estimate = share;
    f.sigma = sigma;
    f.sigmas = (share - 0.03) / sigma;
  }
  if (totals->failed > totals->pairs) {
    c->Add(DoctorKind::kTrackJumps, DoctorSeverity::kError, CameraName(camera),
           Text("in %d of %d pairs of images no motion fits two fifths of the tracks",
                totals->failed, totals->failed + totals->pairs),
           "track numbers are not kept, or most tracks are wrong")
        .count = totals->failed;
  }
  const auto pairs = static_cast<double>(totals->noise.size());
  const double noise = QuantileOf(&totals->noise, 0.5);
  c->report.facts.pixel_noise = std::max(c->report.facts.pixel_noise, noise);
  const double sigma_px = c->input.cameras[camera].sigma_px;
  // The median of medians of about 50 errors each.
  const double relative = 0.2 / std::sqrt(pairs);
  if (!(noise > 1.7 || noise < 0.25)) return;
  const bool too_small = noise > 1.0;
  DoctorFinding& f = c->Add(
      DoctorKind::kPixelNoise,
      noise > 3.0 ? DoctorSeverity::kError
                  : (too_small ? DoctorSeverity::kWarning : DoctorSeverity::kInfo),
      CameraName(camera),
      Text("tracks scatter by %.3g px about their epipolar lines, %.2g times the given sigma: %s",
           noise * sigma_px, noise,
           too_small ? "dangerous, the estimator trusts them too much"
                     : "safe, but tracks weigh less than they could"),
      too_small ? "raise sigma_px, or check distortion and focal length"
                : "lower sigma_px if tracks do not drift over their lives");
  f.estimate = noise;
  f.sigma = noise * relative;
  f.sigmas = std::abs(std::log(noise)) / relative;
}

}  // namespace

void CheckTrackGeometry(DoctorCase* c) {
  if (c->frames.size() < 2) return;
  for (std::size_t camera = 0; camera < c->camera_ok.size(); ++camera) {
    if (!c->camera_ok[camera]) continue;
    Totals totals;
    const std::size_t last = c->frames.size() - 1;
    const std::size_t wanted = std::min(last, Index(c->options.max_frame_pairs));
    for (std::size_t k = 0; k < wanted; ++k) {
      const std::size_t from = k * last / wanted;
      std::vector<TwoViewMatch> matches;
      const std::size_t to = Partner(*c, camera, from, &matches);
      if (to > 0) AddPair(camera, from, to, matches, &totals, c);
    }
    Report(camera, &totals, c);
  }
  c->report.facts.frame_pairs = static_cast<int>(c->pairs.size());
}

}  // namespace glissade::internal
