// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Stamps of the IMU and of frames: order, gaps, jitter, and whether the one covers the other.
#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "glissade/imu/sample.h"
#include "window/doctor.h"

namespace glissade::internal {

namespace {

/// Neighbours in the order of the file.
struct StampOrder {
  std::int64_t duplicates = 0, swapped = 0, backward = 0;
  std::int64_t first_duplicate = 0, first_swapped = 0, first_backward = 0;
  double furthest_back_s = 0.0;
};

StampOrder OrderOf(std::span<const std::int64_t> stamps) {
  StampOrder order;
  const auto count = [](std::int64_t stamp, std::int64_t* n, std::int64_t* first) {
    if ((*n)++ == 0) *first = stamp;
  };
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] > stamps[i - 1]) continue;
    if (stamps[i] == stamps[i - 1]) {
      count(stamps[i], &order.duplicates, &order.first_duplicate);
      continue;
    }
    // a c b d: the two in the middle would be in order the other way round.
    const bool after = i < 2 || stamps[i] > stamps[i - 2];
    const bool before = i + 1 == stamps.size() || stamps[i - 1] < stamps[i + 1];
    if (after && before) {
      count(stamps[i], &order.swapped, &order.first_swapped);
    } else {
      count(stamps[i], &order.backward, &order.first_backward);
    }
    order.furthest_back_s =
        std::max(order.furthest_back_s, SecondsBetween(stamps[i], stamps[i - 1]));
  }
  return order;
}

/// Intervals between stamps in order of time.
struct Intervals {
  double median = 0.0, jitter = 0.0, longest = 0.0;
  double longest_from = 0.0;  ///< where the longest begins
  std::int64_t regular = 0;   ///< intervals that jitter is of
  std::int64_t gaps = 0;
  double missing = 0.0;  ///< stamps that would fit into the gaps
};

/// Longer than this many median intervals: something is missing there.
constexpr double kGap = 2.5;

Intervals IntervalsOf(const std::vector<double>& times) {
  Intervals r;
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double step = times[i] - times[i - 1];
    if (step > r.longest) {
      r.longest = step;
      r.longest_from = times[i - 1];
    }
    steps.push_back(step);
  }
  r.median = QuantileOf(&steps, 0.5);
  double sum = 0.0;
  for (const double step : steps) {
    if (step > kGap * r.median) {
      ++r.gaps;
      r.missing += std::round(step / r.median) - 1.0;
    } else {
      sum += (step - r.median) * (step - r.median);
      ++r.regular;
    }
  }
  r.jitter = r.regular > 0 ? std::sqrt(sum / static_cast<double>(r.regular)) : 0.0;
  return r;
}

struct OrderKinds {
  DoctorKind out_of_order, swapped, duplicate;
  const char* sensor;
  const char* things;
};

void ReportOrder(const StampOrder& order, const OrderKinds& kinds, DoctorCase* c) {
  if (order.backward > 0) {
    DoctorFinding& f =
        c->Add(kinds.out_of_order, DoctorSeverity::kError, kinds.sensor,
               Text("time goes back %lld times, by up to %.6g s",
                    static_cast<long long>(order.backward), order.furthest_back_s),
               "sort by stamp; where the clock was reset, split the recording there");
    f.stamp_ns = order.first_backward;
    f.count = order.backward;
    f.estimate = order.furthest_back_s;
    f.unit = "s";
  }
  if (order.swapped > 0) {
    DoctorFinding& f = c->Add(kinds.swapped, DoctorSeverity::kError, kinds.sensor,
                              Text("%lld pairs of neighbouring %s have their stamps exchanged",
                                   static_cast<long long>(order.swapped), kinds.things),
                              "sort by stamp; if values jump then, only the stamps were exchanged");
    f.stamp_ns = order.first_swapped;
    f.count = order.swapped;
  }
  if (order.duplicates > 0) {
    DoctorFinding& f = c->Add(kinds.duplicate, DoctorSeverity::kError, kinds.sensor,
                              Text("%lld %s have the stamp of the one before",
                                   static_cast<long long>(order.duplicates), kinds.things),
                              "drop all but the first; look for a driver that publishes twice");
    f.stamp_ns = order.first_duplicate;
    f.count = order.duplicates;
  }
}

/// How many standard deviations a jitter measured over n intervals lies above a limit.
double SigmasAbove(double jitter, double limit, std::int64_t n) {
  const double sigma = jitter / std::sqrt(2.0 * static_cast<double>(std::max<std::int64_t>(n, 1)));
  return sigma > 0.0 ? (jitter - limit) / sigma : 0.0;
}

/// What to say of gaps and jitter of a stream.
struct IntervalWords {
  const char* where;
  const char* what;  ///< is missing in a gap
  DoctorKind gap;
  DoctorSeverity gap_severity;
  const char* gap_advice;
  DoctorKind jitter;
  DoctorSeverity jitter_severity;
  const char* jitter_advice;
};

void ReportIntervals(const Intervals& r, const IntervalWords& words, DoctorCase* c) {
  if (r.gaps > 0) {
    DoctorFinding& f = c->Add(
        words.gap, words.gap_severity, words.where,
        Text("%lld gaps, the longest %.4g s; about %.0f %s are missing",
             static_cast<long long>(r.gaps), r.longest, std::min(r.missing, 1e15), words.what),
        words.gap_advice);
    f.stamp_ns = c->Stamp(r.longest_from);
    f.count = r.gaps;
    f.estimate = r.longest;
    f.unit = "s";
  }
  // A tenth of an interval moves a reading of 1 rad/s^2 at 200 Hz by 5e-4 rad/s.
  const double limit = 0.1 * r.median;
  const double z = SigmasAbove(r.jitter, limit, r.regular);
  if (!(r.jitter > limit && z > 3.0)) return;
  DoctorFinding& f = c->Add(
      words.jitter, words.jitter_severity, words.where,
      Text("intervals scatter by %.3g ms (rms) about %.4g ms", 1e3 * r.jitter, 1e3 * r.median),
      words.jitter_advice);
  f.sigmas = z;
  f.count = r.regular;
  f.estimate = r.jitter;
  f.sigma = r.jitter / std::sqrt(2.0 * static_cast<double>(r.regular));
  f.unit = "s";
}

}  // namespace

void CheckImuStamps(DoctorCase* c) {
  const DoctorInput& in = c->input;
  if (in.imu.empty()) return;
  std::vector<std::int64_t> stamps;
  for (const ImuSample& s : in.imu)
    stamps.push_back(s.stamp_ns);
  ReportOrder(OrderOf(stamps),
              {DoctorKind::kImuOutOfOrder, DoctorKind::kImuSwappedStamps,
               DoctorKind::kImuDuplicateStamp, "imu", "samples"},
              c);

  // From here on in order of time; gaps left by readings that are no numbers count as gaps.
  std::stable_sort(c->imu.begin(), c->imu.end(),
                   [](const DoctorSample& a, const DoctorSample& b) { return a.t < b.t; });
  c->imu.erase(std::unique(c->imu.begin(), c->imu.end(),
                           [](const DoctorSample& a, const DoctorSample& b) { return a.t == b.t; }),
               c->imu.end());
  std::vector<double> times;
  for (const DoctorSample& s : c->imu)
    times.push_back(s.t);
  const Intervals r = IntervalsOf(times);
  c->imu_dt = r.median;
  c->imu_max_gap = 1e-9 * static_cast<double>(kMaxImuGapNs);
  if (in.imu_noise && in.imu_noise->max_gap_ns > 0) {
    c->imu_max_gap = 1e-9 * static_cast<double>(in.imu_noise->max_gap_ns);
  }
  c->imu_max_gap = std::max(c->imu_max_gap, kGap * r.median);
  DoctorFacts& facts = c->report.facts;
  if (!(r.median > 0.0)) return;
  facts.imu_rate_hz = 1.0 / r.median;
  facts.imu_jitter_s = r.jitter;
  facts.imu_longest_s = r.longest;
  facts.duration_s = times.back() - times.front();

  const bool long_gap = r.longest > c->imu_max_gap;
  ReportIntervals(
      r,
      {"imu", "samples", DoctorKind::kImuGap,
       long_gap ? DoctorSeverity::kError : DoctorSeverity::kWarning,
       long_gap
           ? "record again, or keep ImuNoise::gaps = kInflate: what happened in them is unknown"
           : "a driver or bus that loses samples: look at its queue sizes",
       DoctorKind::kImuJitter, DoctorSeverity::kWarning,
       "stamps are of arrival: take the sensor's own clock, or fit a line to them"},
      c);
  if (in.imu_rate_hz > 0.0 && std::isfinite(in.imu_rate_hz)) {
    const double ratio = facts.imu_rate_hz / in.imu_rate_hz;
    if (!(std::abs(ratio - 1.0) < 0.05)) {
      DoctorFinding& f = c->Add(
          DoctorKind::kImuRate, DoctorSeverity::kWarning, "imu",
          Text("%.5g Hz, while %.5g Hz was given", facts.imu_rate_hz, in.imu_rate_hz),
          "correct the given rate, or find out where samples went or what unit the stamps have");
      f.estimate = facts.imu_rate_hz;
      f.sigma = facts.imu_rate_hz * r.jitter /
                (r.median * std::sqrt(static_cast<double>(std::max<std::int64_t>(r.regular, 1))));
      f.unit = "Hz";
    }
  }
}

void CheckFrameStamps(DoctorCase* c) {
  const DoctorInput& in = c->input;
  if (in.frames.empty()) {
    c->Add(DoctorKind::kNoFrames, DoctorSeverity::kInfo, "frames", "there are no frames",
           "nothing about the cameras was checked");
    return;
  }
  std::vector<std::int64_t> stamps;
  for (const FrameObservations& frame : in.frames)
    stamps.push_back(frame.stamp_ns);
  ReportOrder(OrderOf(stamps),
              {DoctorKind::kFrameOutOfOrder, DoctorKind::kFrameSwappedStamps,
               DoctorKind::kFrameDuplicateStamp, "frames", "frames"},
              c);
  std::vector<double> times;
  for (const std::int64_t stamp : stamps)
    times.push_back(c->Seconds(stamp));
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  const Intervals r = IntervalsOf(times);
  DoctorFacts& facts = c->report.facts;
  facts.duration_s = times.back() - times.front();
  if (r.median > 0.0) {
    facts.frame_rate_hz = 1.0 / r.median;
    facts.frame_jitter_s = r.jitter;
    facts.frame_longest_s = r.longest;
    const bool long_gap = r.longest > 0.5 && r.longest > 3.5 * r.median;
    // A front end that chooses its frames is not regular, and need not be.
    ReportIntervals(
        r,
        {"frames", "frames", DoctorKind::kFrameGap,
         long_gap ? DoctorSeverity::kWarning : DoctorSeverity::kInfo,
         "tracks end there: without an IMU the path breaks, with one it drifts",
         DoctorKind::kFrameJitter, DoctorSeverity::kInfo,
         "harmless if frames were chosen; if the camera runs freely, stamps are of arrival"},
        c);
  }
  if (c->imu.empty()) return;
  std::int64_t outside = 0;
  std::optional<double> where;
  for (const double t : times) {
    if (t >= c->imu.front().t && t <= c->imu.back().t) continue;
    ++outside;
    if (!where) where = t;
  }
  const auto all = static_cast<double>(times.size());
  facts.imu_coverage = 1.0 - static_cast<double>(outside) / all;
  if (outside == 0) return;
  const bool most = facts.imu_coverage < 0.5;
  DoctorFinding& f = c->Add(
      DoctorKind::kFrameOutsideImu, most ? DoctorSeverity::kError : DoctorSeverity::kWarning,
      "frames",
      Text("%lld of %zu frames are outside of the IMU's time, which is %.4g s to %.4g s",
           static_cast<long long>(outside), times.size(), c->imu.front().t, c->imu.back().t),
      most
          ? Text("two clocks, or two units of time: frames run from %.6g s to %.6g s on that scale",
                 times.front(), times.back())
          : Text("start the IMU before the camera and stop it after, or drop these frames"));
  f.stamp_ns = c->Stamp(*where);
  f.count = outside;
  f.estimate = facts.imu_coverage;
}

}  // namespace glissade::internal
