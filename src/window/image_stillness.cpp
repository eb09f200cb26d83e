// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "glissade/imu/sample.h"
#include "glissade/window/stillness.h"
#include "window/quantiles.h"
#include "window/verdicts.h"

namespace glissade {

namespace {

constexpr int kMinTracks = 8;
constexpr double kWrongShare = 0.3;         // of tracks that lead elsewhere
constexpr double kChi2Median = 1.38629436;  // 2 degrees of freedom: 2 ln 2

/// Sums for a straight line through u(t), v(t).
struct Line {
  int n = 0;
  double t = 0.0, tt = 0.0, u = 0.0, v = 0.0, tu = 0.0, tv = 0.0;

  void Add(double at, double pu, double pv) {
    ++n;
    t += at;
    tt += at * at;
    u += pu;
    v += pv;
    tu += at * pu;
    tv += at * pv;
  }
  /// (slope_u^2 / var_u + slope_v^2 / var_v) with the variances of a pixel.
  [[nodiscard]] double Chi2(double var_u, double var_v) const {
    const double stt = tt - t * t / n;
    const double su = tu - t * u / n, sv = tv - t * v / n;
    return (su * su / var_u + sv * sv / var_v) / stt;
  }
};

}  // namespace

ImageStillnessTest TestImageStillness(std::span<const WindowCamera> cameras,
                                      std::span<const FrameObservations> frames,
                                      const StillnessOptions& options) {
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
    test.verdict = internal::InvalidInput(s);
    return test;
  }

  std::map<std::pair<int, std::int64_t>, Line> lines;
  for (const FrameObservations& frame : frames) {
    const double t = SecondsBetween(frames.front().stamp_ns, frame.stamp_ns);
    for (const FrameObservation& o : frame.observations) {
      if (o.camera < 0 || static_cast<std::size_t>(o.camera) >= cameras.size()) {
        test.verdict = {InitReason::kInvalidInput, 0.0, 0.0, "observation by a camera that is not"};
        return test;
      }
      // About the principal point: fewer digits are lost.
      const WindowCamera& c = cameras[static_cast<std::size_t>(o.camera)];
      lines[{o.camera, o.track}].Add(t, o.u - c.cx, o.v - c.cy);
    }
  }
  for (const auto& [key, line] : lines) {
    if (line.n < 2) continue;
    const WindowCamera& c = cameras[static_cast<std::size_t>(key.first)];
    const double sigma2 = c.sigma_px * c.sigma_px;
    const double tremble_u = c.fx * options.tremble_angle, tremble_v = c.fy * options.tremble_angle;
    const double chi2 = line.Chi2(sigma2 + tremble_u * tremble_u, sigma2 + tremble_v * tremble_v);
    ++test.tracks;
    if (!(chi2 <= kChi2Median)) ++test.moved;
  }
  if (test.tracks < kMinTracks) {
    test.verdict = internal::Refusal(InitReason::kTooFewTracks, test.tracks, kMinTracks,
                                     "number of tracks seen twice", "");
    return test;
  }
  const double p = 0.5 + 0.5 * kWrongShare;
  const double spread = std::sqrt(test.tracks * p * (1.0 - p));
  const double z = internal::NormalQuantile(options.false_alarm);
  test.max_moved = static_cast<int>(std::floor(test.tracks * p + z * spread));
  // A few tracks that all move must be able to say so.
  test.max_moved = std::min(test.max_moved, test.tracks - 1);
  if (test.moved > test.max_moved) {
    test.verdict = internal::Refusal(InitReason::kMoving, test.moved, test.max_moved,
                                     "number of tracks that move in the images", "");
  }
  return test;
}

}  // namespace glissade
