// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/data_doctor.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "glissade/imu/sample.h"
#include "window/doctor.h"

namespace glissade {

namespace {

void KeepFinite(std::optional<double>* x) {
  if (x->has_value() && !std::isfinite(**x)) x->reset();
}

void KeepFinite(double* x) {
  if (!std::isfinite(*x)) *x = 0.0;
}

void KeepFinite(std::optional<Vector3>* x) {
  if (x->has_value() && !(*x)->allFinite()) x->reset();
}

/// The last line of defence: input of any size can overflow on the way.
void KeepFinite(DoctorReport* report) {
  for (DoctorFinding& f : report->findings) {
    KeepFinite(&f.sigmas);
    KeepFinite(&f.estimate);
    KeepFinite(&f.sigma);
  }
  DoctorFacts& facts = report->facts;
  for (double* x : {&facts.imu_rate_hz, &facts.imu_jitter_s, &facts.imu_longest_s,
                    &facts.frame_rate_hz, &facts.frame_jitter_s, &facts.frame_longest_s,
                    &facts.duration_s, &facts.imu_coverage, &facts.quiet_accel,
                    &facts.gyro_noise_density, &facts.accel_noise_density, &facts.tracks_per_frame,
                    &facts.median_track_length, &facts.outlier_share, &facts.pixel_noise}) {
    KeepFinite(x);
  }
  if (!facts.mean_accel.allFinite()) facts.mean_accel.setZero();
  KeepFinite(&facts.time_offset_s);
  KeepFinite(&facts.time_offset_sigma_s);
  KeepFinite(&facts.extrinsic_error);
  KeepFinite(&facts.gyro_bias);
}

DoctorOptions Sensible(DoctorOptions options) {
  const DoctorOptions defaults;
  if (!(options.max_time_offset_s >= 0.0 && options.max_time_offset_s <= 10.0)) {
    options.max_time_offset_s = defaults.max_time_offset_s;
  }
  if (options.max_frame_pairs < 1) options.max_frame_pairs = defaults.max_frame_pairs;
  return options;
}

}  // namespace

std::string_view ToString(DoctorSeverity severity) {
  switch (severity) {
    case DoctorSeverity::kInfo:
      return "info";
    case DoctorSeverity::kWarning:
      return "warning";
    case DoctorSeverity::kError:
      return "error";
  }
  return "none";
}

std::string_view ToString(DoctorKind kind) {
  switch (kind) {
    case DoctorKind::kTimeOffset:
      return "time_offset";
    case DoctorKind::kGyroUnits:
      return "gyro_units";
    case DoctorKind::kGyroScale:
      return "gyro_scale";
    case DoctorKind::kGyroAxes:
      return "gyro_axes";
    case DoctorKind::kExtrinsicRotation:
      return "extrinsic_rotation";
    case DoctorKind::kFrameOutsideImu:
      return "frame_outside_imu";
    case DoctorKind::kNotComparable:
      return "not_comparable";
    case DoctorKind::kNoImu:
      return "no_imu";
    case DoctorKind::kBadNoise:
      return "bad_noise";
    case DoctorKind::kImuNotFinite:
      return "imu_not_finite";
    case DoctorKind::kImuOutOfOrder:
      return "imu_out_of_order";
    case DoctorKind::kImuSwappedStamps:
      return "imu_swapped_stamps";
    case DoctorKind::kImuDuplicateStamp:
      return "imu_duplicate_stamp";
    case DoctorKind::kImuGap:
      return "imu_gap";
    case DoctorKind::kImuJitter:
      return "imu_jitter";
    case DoctorKind::kImuRate:
      return "imu_rate";
    case DoctorKind::kImuStuck:
      return "imu_stuck";
    case DoctorKind::kImuRepeated:
      return "imu_repeated";
    case DoctorKind::kImuSaturated:
      return "imu_saturated";
    case DoctorKind::kAccelUnits:
      return "accel_units";
    case DoctorKind::kGravity:
      return "gravity";
    case DoctorKind::kGyroNoise:
      return "gyro_noise";
    case DoctorKind::kAccelNoise:
      return "accel_noise";
    case DoctorKind::kNoFrames:
      return "no_frames";
    case DoctorKind::kFrameOutOfOrder:
      return "frame_out_of_order";
    case DoctorKind::kFrameSwappedStamps:
      return "frame_swapped_stamps";
    case DoctorKind::kFrameDuplicateStamp:
      return "frame_duplicate_stamp";
    case DoctorKind::kFrameGap:
      return "frame_gap";
    case DoctorKind::kFrameJitter:
      return "frame_jitter";
    case DoctorKind::kNoTracks:
      return "no_tracks";
    case DoctorKind::kBadCamera:
      return "bad_camera";
    case DoctorKind::kUnknownCamera:
      return "unknown_camera";
    case DoctorKind::kPixelNotFinite:
      return "pixel_not_finite";
    case DoctorKind::kDuplicateObservation:
      return "duplicate_observation";
    case DoctorKind::kOutsideImage:
      return "outside_image";
    case DoctorKind::kFewTracks:
      return "few_tracks";
    case DoctorKind::kShortTracks:
      return "short_tracks";
    case DoctorKind::kTrackJumps:
      return "track_jumps";
    case DoctorKind::kPixelNoise:
      return "pixel_noise";
    case DoctorKind::kStereoSwapped:
      return "stereo_swapped";
    case DoctorKind::kStereoExtrinsic:
      return "stereo_extrinsic";
    case DoctorKind::kStereoOutliers:
      return "stereo_outliers";
  }
  return "none";
}

DoctorSeverity DoctorReport::Worst() const {
  DoctorSeverity worst = DoctorSeverity::kInfo;
  for (const DoctorFinding& f : findings)
    worst = std::max(worst, f.severity);
  return worst;
}

const DoctorFinding* DoctorReport::Find(DoctorKind kind) const {
  for (const DoctorFinding& f : findings) {
    if (f.kind == kind) return &f;
  }
  return nullptr;
}

DoctorReport Diagnose(const DoctorInput& input, const DoctorOptions& options) {
  internal::DoctorCase c(input, Sensible(options));
  if (!input.imu.empty()) {
    c.origin_ns = input.imu.front().stamp_ns;
  } else if (!input.frames.empty()) {
    c.origin_ns = input.frames.front().stamp_ns;
  }
  internal::CheckImuValues(&c);
  internal::CheckImuStamps(&c);
  internal::CheckFrameStamps(&c);
  internal::CheckObservations(&c);
  internal::CheckTrackCounts(&c);
  internal::CheckGravity(&c);
  internal::CheckTrackGeometry(&c);
  internal::CheckStereo(&c);
  internal::CheckGyroAgainstTracks(&c);
  internal::CheckImuRepetition(&c);
  internal::CheckImuNoise(&c);
  KeepFinite(&c.report);
  std::stable_sort(c.report.findings.begin(), c.report.findings.end(),
                   [](const DoctorFinding& a, const DoctorFinding& b) {
                     return a.severity != b.severity ? a.severity > b.severity : a.kind < b.kind;
                   });
  return std::move(c.report);
}

namespace internal {

double DoctorCase::Seconds(std::int64_t stamp_ns) const {
  return stamp_ns >= origin_ns ? SecondsBetween(origin_ns, stamp_ns)
                               : -SecondsBetween(stamp_ns, origin_ns);
}

std::int64_t DoctorCase::Stamp(double t) const {
  // Unsigned arithmetic: a sum that does not fit wraps instead of being undefined.
  const double ns = std::clamp(1e9 * t, -9e18, 9e18);
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(origin_ns) +
                                   static_cast<std::uint64_t>(std::llround(ns)));
}

DoctorFinding& DoctorCase::Add(DoctorKind kind, DoctorSeverity severity, std::string sensor,
                               std::string message, std::string advice) {
  DoctorFinding& f = report.findings.emplace_back();
  f.kind = kind;
  f.severity = severity;
  f.sensor = std::move(sensor);
  f.message = std::move(message);
  f.advice = std::move(advice);
  return f;
}

std::string Text(const char* format, ...) {
  char buffer[512];
  std::va_list arguments;
  va_start(arguments, format);
  const int n = std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return n > 0 ? std::string(buffer) : std::string();
}

double QuantileOf(std::vector<double>* values, double p) {
  if (values->empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(p * static_cast<double>(values->size() - 1) + 0.5);
  std::nth_element(values->begin(), values->begin() + at, values->end());
  return (*values)[static_cast<std::size_t>(at)];
}

}  // namespace internal

}  // namespace glissade
