// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/fault.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "common/options.h"

namespace glissade::app {

namespace {

constexpr double kMaxSeconds = 1e6;

/// In [0, 1), the same with every standard library.
double Uniform(std::mt19937_64* random) {
  return 0x1p-53 * static_cast<double>((*random)() >> 11);
}

/// Clips to half of the largest rate and of the largest deviation of the specific force from
/// gravity that the fault meets, and marks what was clipped as a driver does.
void Saturate(Viotracks* recording, const Fault& fault) {
  const std::int64_t first = recording->frames.front().stamp_ns;
  const double g = recording->gravity.norm();
  double rate = 0.0, motion = 0.0;
  for (const ImuSample& sample : recording->imu) {
    if (!fault.Holds(sample.stamp_ns, first)) continue;
    rate = std::max(rate, sample.gyro.cwiseAbs().maxCoeff());
    motion = std::max(motion, sample.accel.cwiseAbs().maxCoeff() - g);
  }
  const double gyro_range = 0.5 * rate, accel_range = g + 0.5 * std::max(0.0, motion);
  for (ImuSample& sample : recording->imu) {
    if (!fault.Holds(sample.stamp_ns, first)) continue;
    sample.gyro_saturated = sample.gyro.cwiseAbs().maxCoeff() >= gyro_range;
    sample.accel_saturated = sample.accel.cwiseAbs().maxCoeff() >= accel_range;
    sample.gyro = sample.gyro.cwiseMin(gyro_range).cwiseMax(-gyro_range);
    sample.accel = sample.accel.cwiseMin(accel_range).cwiseMax(-accel_range);
  }
}

void ApplyToImu(Viotracks* recording, const Fault& fault) {
  const std::int64_t first = recording->frames.front().stamp_ns;
  const auto holds = [&](const ImuSample& s) { return fault.Holds(s.stamp_ns, first); };
  std::vector<ImuSample>& imu = recording->imu;
  switch (fault.kind) {
    case FaultKind::kImuGap:
      std::erase_if(imu, holds);
      return;
    case FaultKind::kImuSaturated:
      Saturate(recording, fault);
      return;
    case FaultKind::kImuOutOfOrder:
      for (std::size_t k = 0; k + 1 < imu.size(); ++k) {
        if (!holds(imu[k]) || !holds(imu[k + 1])) continue;
        std::swap(imu[k], imu[k + 1]);
        ++k;
      }
      return;
    case FaultKind::kImuDuplicate: {
      std::vector<ImuSample> twice;
      for (const ImuSample& sample : imu)
        twice.insert(twice.end(), holds(sample) ? 2 : 1, sample);
      imu = std::move(twice);
      return;
    }
    default:
      return;
  }
}

}  // namespace

const std::vector<std::string>& FaultNames() {
  static const std::vector<std::string> names = {
      "imu-gap",          "no-features",   "all-outliers",    "camera-lost",
      "nan-pixels",       "imu-saturated", "frame-duplicate", "frame-out-of-order",
      "imu-out-of-order", "imu-duplicate"};
  return names;
}

Result<Fault> ParseFault(const std::string& text) {
  const auto parsed = ParseNamedTime(FaultNames(), text);
  if (!parsed.ok()) return parsed.status();
  return Fault{static_cast<FaultKind>(parsed->name), parsed->begin_s, parsed->end_s};
}

Result<NamedTime> ParseNamedTime(const std::vector<std::string>& names, const std::string& text) {
  const std::size_t at = text.find('@'), dots = text.find("..");
  const auto name = std::find(names.begin(), names.end(), text.substr(0, at));
  if (at == std::string::npos || dots == std::string::npos || dots < at || name == names.end()) {
    return Status(StatusCode::kInvalidArgument,
                  fmt::format("--fault: must be KIND@T..T with seconds after the first frame and "
                              "KIND one of {}, not '{}'",
                              Listed(names), text));
  }
  const auto begin = ParseNumber("--fault", text.substr(at + 1, dots - at - 1), 0.0, kMaxSeconds);
  if (!begin.ok()) return begin.status();
  const auto end = ParseNumber("--fault", text.substr(dots + 2), 0.0, kMaxSeconds);
  if (!end.ok()) return end.status();
  if (!(*end > *begin)) {
    return Status(StatusCode::kInvalidArgument,
                  fmt::format("--fault: must end after it begins, not '{}'", text));
  }
  return NamedTime{static_cast<std::size_t>(name - names.begin()), *begin, *end};
}

Viotracks WithImuFaults(Viotracks recording, std::span<const Fault> faults) {
  for (const Fault& fault : faults) {
    if (!recording.frames.empty()) ApplyToImu(&recording, fault);
  }
  return recording;
}

FaultyReplay::FaultyReplay(const Viotracks& recording, const ReplayOptions& options,
                           std::vector<Fault> faults)
    : recording_(&recording), replay_(recording, options), faults_(std::move(faults)) {}

bool FaultyReplay::Happens(FaultKind kind, std::size_t frame) const {
  const std::int64_t stamp = recording_->frames[frame].stamp_ns;
  return std::any_of(faults_.begin(), faults_.end(), [&](const Fault& fault) {
    return fault.kind == kind && fault.Holds(stamp, recording_->frames.front().stamp_ns);
  });
}

void FaultyReplay::Tamper(Delivery* d) {
  if (Happens(FaultKind::kNoFeatures, d->frame)) d->observations.clear();
  if (Happens(FaultKind::kCameraLost, d->frame)) {
    std::erase_if(d->observations, [](const FrameObservation& o) { return o.camera == 1; });
  }
  if (Happens(FaultKind::kAllOutliers, d->frame)) {
    for (FrameObservation& o : d->observations) {
      const ViotracksCamera& camera = recording_->cameras[static_cast<std::size_t>(o.camera)];
      o.u = camera.width * Uniform(&random_);
      o.v = camera.height * Uniform(&random_);
    }
  }
  if (Happens(FaultKind::kNanPixels, d->frame)) {
    for (std::size_t k = 0; k < d->observations.size(); k += 2)
      d->observations[k].u = std::numeric_limits<double>::quiet_NaN();
  }
}

bool FaultyReplay::Take(Delivery* d) {
  if (!replay_.Next()) return false;
  d->frame = replay_.frame();
  d->stamp_ns = replay_.stamp_ns();
  d->imu.assign(replay_.imu().begin(), replay_.imu().end());
  d->observations.assign(replay_.observations().begin(), replay_.observations().end());
  Tamper(d);
  return true;
}

const Delivery* FaultyReplay::Next() {
  if (is_waiting_) {
    is_waiting_ = false;
    std::swap(current_, waiting_);
    return &current_;
  }
  if (!Take(&current_)) return nullptr;
  if (Happens(FaultKind::kFrameDuplicate, current_.frame)) {
    waiting_ = current_;
    waiting_.imu.clear();
    is_waiting_ = true;
  } else if (Happens(FaultKind::kFrameOutOfOrder, current_.frame) && Take(&waiting_)) {
    // The later one comes first, and with it all samples until then.
    std::swap(current_, waiting_);
    current_.imu.insert(current_.imu.begin(), waiting_.imu.begin(), waiting_.imu.end());
    waiting_.imu.clear();
    is_waiting_ = true;
  }
  return &current_;
}

}  // namespace glissade::app
