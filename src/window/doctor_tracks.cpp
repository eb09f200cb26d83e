// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Observations one by one, and how many tracks there are and how long.
#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "window/doctor.h"

namespace glissade::internal {

namespace {

/// Pixels beyond this are none; so are rays nearly at a right angle to the optical axis.
constexpr double kNoPixel = 1e7;
constexpr double kNoRay = 1e3;

/// Something counted over observations, and the first frame that has it.
struct Count {
  std::int64_t n = 0, first_stamp = 0;
  void Add(std::int64_t stamp) {
    if (n++ == 0) first_stamp = stamp;
  }
};

DoctorFinding& Report(const Count& count, DoctorKind kind, DoctorSeverity severity,
                      std::string sensor, std::string message, std::string advice, DoctorCase* c) {
  DoctorFinding& f =
      c->Add(kind, severity, std::move(sensor), std::move(message), std::move(advice));
  f.count = count.n;
  f.stamp_ns = count.first_stamp;
  return f;
}

void CheckCameras(DoctorCase* c) {
  const auto cameras = c->input.cameras;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Status status = cameras[i].Validate();
    c->camera_ok.push_back(status.ok());
    if (status.ok()) continue;
    c->Add(DoctorKind::kBadCamera, DoctorSeverity::kError, CameraName(i), status.message(),
           "correct the calibration; nothing else about this camera was checked");
  }
}

/// What is wrong with observations of one camera.
struct CameraCounts {
  Count outside, duplicate, not_finite;
  std::int64_t all = 0;
};

/// Takes what can be used of a frame.
void TakeFrame(const FrameObservations& frame, std::vector<CameraCounts>* counts, Count* unknown,
               DoctorCase* c) {
  const DoctorInput& in = c->input;
  DoctorFrame& to = c->frames.emplace_back();
  to.stamp_ns = frame.stamp_ns;
  to.t = c->Seconds(frame.stamp_ns);
  to.features.resize(in.cameras.size());
  for (const FrameObservation& o : frame.observations) {
    if (o.camera < 0 || Index(o.camera) >= in.cameras.size()) {
      unknown->Add(frame.stamp_ns);
      continue;
    }
    const std::size_t camera = Index(o.camera);
    CameraCounts& count = (*counts)[camera];
    ++count.all;
    if (!(std::abs(o.u) <= kNoPixel && std::abs(o.v) <= kNoPixel)) {
      count.not_finite.Add(frame.stamp_ns);
      continue;
    }
    if (!c->camera_ok[camera]) continue;
    const WindowCamera& k = in.cameras[camera];
    if (in.image_sizes.size() == in.cameras.size()) {
      // Noise and subpixel refinement may carry a feature a little over the border.
      const DoctorImageSize& size = in.image_sizes[camera];
      const double margin = 1.0 + 5.0 * k.sigma_px;
      if (size.width > 0 && size.height > 0 &&
          !(o.u >= -margin && o.v >= -margin && o.u <= size.width - 1 + margin &&
            o.v <= size.height - 1 + margin)) {
        count.outside.Add(frame.stamp_ns);
      }
    }
    const Vector2 ray = k.Normalized(o.u, o.v);
    if (!(std::abs(ray[0]) < kNoRay && std::abs(ray[1]) < kNoRay)) continue;
    to.features[camera].push_back({o.track, ray[0], ray[1]});
  }
  for (std::size_t camera = 0; camera < to.features.size(); ++camera) {
    std::vector<DoctorFeature>& features = to.features[camera];
    std::stable_sort(
        features.begin(), features.end(),
        [](const DoctorFeature& a, const DoctorFeature& b) { return a.track < b.track; });
    const auto same = [](const DoctorFeature& a, const DoctorFeature& b) {
      return a.track == b.track;
    };
    const auto end = std::unique(features.begin(), features.end(), same);
    for (auto i = end; i != features.end(); ++i)
      (*counts)[camera].duplicate.Add(frame.stamp_ns);
    features.erase(end, features.end());
  }
}

void ReportCamera(std::size_t camera, const CameraCounts& counts, DoctorCase* c) {
  const auto n = [](const Count& count) { return static_cast<long long>(count.n); };
  if (counts.not_finite.n > 0) {
    Report(
        counts.not_finite, DoctorKind::kPixelNotFinite, DoctorSeverity::kError, CameraName(camera),
        Text("%lld observations are no numbers, or beyond %.0e px", n(counts.not_finite), kNoPixel),
        "drop them; a tracker that divides by zero, or an undistortion that does not converge", c);
  }
  if (counts.duplicate.n > 0) {
    Report(
        counts.duplicate, DoctorKind::kDuplicateObservation, DoctorSeverity::kError,
        CameraName(camera),
        Text("%lld observations of a track that the same image already has", n(counts.duplicate)),
        "keep one: a point seen twice counts twice; two points under one number are outliers", c);
  }
  if (counts.outside.n > 0) {
    const double share = static_cast<double>(counts.outside.n) / static_cast<double>(counts.all);
    Report(counts.outside, DoctorKind::kOutsideImage,
           share > 0.05    ? DoctorSeverity::kError
           : share > 0.001 ? DoctorSeverity::kWarning
                           : DoctorSeverity::kInfo,
           CameraName(camera),
           Text("%lld observations (%.2g %%) are outside of the image", n(counts.outside),
                100.0 * share),
           "width and height, or cx and cy, of another resolution? Undistorted pixels may be a "
           "little outside",
           c)
        .estimate = share;
  }
}

}  // namespace

void CheckObservations(DoctorCase* c) {
  CheckCameras(c);
  std::vector<CameraCounts> counts(c->input.cameras.size());
  Count unknown;
  for (const FrameObservations& frame : c->input.frames)
    TakeFrame(frame, &counts, &unknown, c);
  if (unknown.n > 0 && !c->input.cameras.empty()) {
    Report(unknown, DoctorKind::kUnknownCamera, DoctorSeverity::kError, "tracks",
           Text("%lld observations are of a camera that is not among the %zu",
                static_cast<long long>(unknown.n), c->input.cameras.size()),
           "cameras are numbered from 0", c);
  }
  for (std::size_t camera = 0; camera < counts.size(); ++camera)
    ReportCamera(camera, counts[camera], c);
  std::stable_sort(c->frames.begin(), c->frames.end(),
                   [](const DoctorFrame& a, const DoctorFrame& b) { return a.t < b.t; });
  c->frames.erase(
      std::unique(c->frames.begin(), c->frames.end(),
                  [](const DoctorFrame& a, const DoctorFrame& b) { return a.t == b.t; }),
      c->frames.end());
}

void CheckTrackCounts(DoctorCase* c) {
  DoctorFacts& facts = c->report.facts;
  std::vector<std::int64_t> seen;  // a track, once a frame
  std::vector<double> all_counts;
  for (std::size_t camera = 0; camera < c->camera_ok.size(); ++camera) {
    if (!c->camera_ok[camera]) continue;
    std::vector<double> counts;
    Count starved;
    for (const DoctorFrame& frame : c->frames) {
      const std::size_t n = frame.features[camera].size();
      counts.push_back(static_cast<double>(n));
      if (n < 8) starved.Add(frame.stamp_ns);
    }
    all_counts.insert(all_counts.end(), counts.begin(), counts.end());
    const double all = static_cast<double>(counts.size());
    const double median = QuantileOf(&counts, 0.5);
    if (counts.empty() || (median == 0.0 && QuantileOf(&counts, 1.0) == 0.0)) continue;
    const double share = static_cast<double>(starved.n) / all;
    if (median < 20.0 || starved.n > 0) {
      const bool bad = median < 8.0 || share > 0.1;
      DoctorFinding& f =
          Report(starved, DoctorKind::kFewTracks,
                 bad ? DoctorSeverity::kError : DoctorSeverity::kWarning, CameraName(camera),
                 Text("%.0f features in the median frame; %lld frames have fewer than 8", median,
                      static_cast<long long>(starved.n)),
                 "let the front end find more (exposure, thresholds, a grid over the image)", c);
      if (starved.n == 0) f.stamp_ns.reset();
      f.estimate = median;
    }
  }
  for (const DoctorFrame& frame : c->frames) {
    const auto begin = static_cast<std::ptrdiff_t>(seen.size());
    for (const auto& features : frame.features) {
      for (const DoctorFeature& feature : features)
        seen.push_back(feature.track);
    }
    std::sort(seen.begin() + begin, seen.end());
    seen.erase(std::unique(seen.begin() + begin, seen.end()), seen.end());
  }
  if (seen.empty()) {
    if (!c->frames.empty()) {
      c->Add(DoctorKind::kNoTracks,
             c->input.cameras.empty() ? DoctorSeverity::kInfo : DoctorSeverity::kError, "tracks",
             "no frame has an observation that can be used", "nothing about tracks was checked");
    }
    return;
  }
  facts.tracks_per_frame = QuantileOf(&all_counts, 0.5);
  constexpr std::size_t kLongest = 30;
  facts.length_histogram.assign(kLongest + 1, 0);
  std::vector<double> lengths;
  std::sort(seen.begin(), seen.end());
  for (std::size_t i = 0; i < seen.size();) {
    std::size_t end = i;
    while (end < seen.size() && seen[end] == seen[i])
      ++end;
    lengths.push_back(static_cast<double>(end - i));
    ++facts.length_histogram[std::min(end - i, kLongest)];
    i = end;
  }
  facts.median_track_length = QuantileOf(&lengths, 0.5);
  // The median of observations, not of tracks: many tracks that die at once do no harm where as
  // many observations belong to long ones.
  double observations = 0.0, in_short_ones = 0.0;
  for (const double length : lengths) {
    observations += length;
    if (length < 3.0) in_short_ones += length;
  }
  const double share = in_short_ones / observations;
  if (share > 0.3 && c->frames.size() >= 3) {
    DoctorFinding& f = c->Add(
        DoctorKind::kShortTracks, share > 0.7 ? DoctorSeverity::kError : DoctorSeverity::kWarning,
        "tracks",
        Text("%.0f %% of the observations are in tracks of one or two frames; median length %.0f",
             100.0 * share, facts.median_track_length),
        "tracks are lost from frame to frame: frame rate, search radius, or numbers given anew");
    f.estimate = share;
  }
}

}  // namespace glissade::internal
