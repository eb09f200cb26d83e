// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "glissade/imu/sample.h"
#include "glissade/window/stillness.h"
#include "window/quantiles.h"
#include "window/stillness.h"
#include "window/verdicts.h"

namespace glissade {

namespace {

constexpr int kMinTracks = 8;
constexpr double kWrongShare = 0.3;         // of tracks that lead elsewhere
constexpr double kChi2Median = 1.38629436;  // 2 degrees of freedom: 2 ln 2

}  // namespace

namespace internal {

void ImageStillness::Line::Add(double at, double pu, double pv) {
  ++n;
  t += at;
  tt += at * at;
  u += pu;
  v += pv;
  tu += at * pu;
  tv += at * pv;
}

double ImageStillness::Line::Chi2(double var_u, double var_v) const {
  const double stt = tt - t * t / n;
  const double su = tu - t * u / n, sv = tv - t * v / n;
  return (su * su / var_u + sv * sv / var_v) / stt;
}

ImageStillness::Line& ImageStillness::LineOf(int camera, std::int64_t track) {
  TrackTable& table = line_of_track_[static_cast<std::size_t>(camera)];
  const int found = table.Find(track);
  if (found >= 0) return lines_[static_cast<std::size_t>(found)];
  table.Set(track, static_cast<int>(lines_.size()));
  lines_.emplace_back().camera = camera;
  return lines_.back();
}

ImageStillnessTest ImageStillness::Test(std::span<const WindowCamera> cameras,
                                        std::span<const FrameObservations> frames,
                                        const StillnessOptions& options, Words words) {
  ImageStillnessTest test;
  Status s = options.Validate();
  for (std::size_t k = 0; s.ok() && k < cameras.size(); ++k)
    s = cameras[k].Validate();
  for (std::size_t k = 1; s.ok() && k < frames.size(); ++k) {
    if (frames[k].stamp_ns <= frames[k - 1].stamp_ns) {
      s = {StatusCode::kInvalidArgument, "stamps of frames do not increase"};
    }
  }
  if (!s.ok()) {
    test.verdict = InvalidInput(s);
    return test;
  }

  lines_.clear();
  line_of_track_.resize(cameras.size());
  for (TrackTable& table : line_of_track_)
    table.Clear();
  for (const FrameObservations& frame : frames) {
    const double t = SecondsBetween(frames.front().stamp_ns, frame.stamp_ns);
    for (const FrameObservation& o : frame.observations) {
      if (o.camera < 0 || static_cast<std::size_t>(o.camera) >= cameras.size()) {
        test.verdict = {InitReason::kInvalidInput, 0.0, 0.0, "observation by a camera that is not"};
        return test;
      }
      // About the principal point: fewer digits are lost.
      const WindowCamera& c = cameras[static_cast<std::size_t>(o.camera)];
      LineOf(o.camera, o.track).Add(t, o.u - c.cx, o.v - c.cy);
    }
  }
  for (const Line& line : lines_) {
    if (line.n < 2) continue;
    const WindowCamera& c = cameras[static_cast<std::size_t>(line.camera)];
    const double sigma2 = c.sigma_px * c.sigma_px;
    const double tremble_u = c.fx * options.tremble_angle, tremble_v = c.fy * options.tremble_angle;
    const double chi2 = line.Chi2(sigma2 + tremble_u * tremble_u, sigma2 + tremble_v * tremble_v);
    ++test.tracks;
    if (!(chi2 <= kChi2Median)) ++test.moved;
  }
  if (test.tracks < kMinTracks) {
    test.verdict = Refusal(InitReason::kTooFewTracks, test.tracks, kMinTracks,
                           "number of tracks seen twice", "", words);
    return test;
  }
  const double p = 0.5 + 0.5 * kWrongShare;
  const double spread = std::sqrt(test.tracks * p * (1.0 - p));
  const double z = NormalQuantile(options.false_alarm);
  test.max_moved = static_cast<int>(std::floor(test.tracks * p + z * spread));
  // A few tracks that all move must be able to say so.
  test.max_moved = std::min(test.max_moved, test.tracks - 1);
  if (test.moved > test.max_moved) {
    test.verdict = Refusal(InitReason::kMoving, test.moved, test.max_moved,
                           "number of tracks that move in the images", "", words);
  }
  return test;
}

}  // namespace internal

ImageStillnessTest TestImageStillness(std::span<const WindowCamera> cameras,
                                      std::span<const FrameObservations> frames,
                                      const StillnessOptions& options) {
  return internal::ImageStillness().Test(cameras, frames, options, internal::Words::kYes);
}

}  // namespace glissade
