// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Values of the IMU that are no numbers, that repeat, or that stop at the end of a range.
#include <algorithm>
#include <array>
#include <cmath>

#include "glissade/base/index.h"
#include "window/doctor.h"

namespace glissade::internal {

namespace {

/// Beyond this no sensor measures, in whatever unit; squares of it do not overflow.
constexpr double kNoReading = 1e7;

bool Usable(const Vector3& x) {
  for (int i = 0; i < 3; ++i) {
    if (!(std::abs(x[i]) <= kNoReading)) return false;
  }
  return true;
}

constexpr std::array<const char*, 6> kAxes = {"gyro x",  "gyro y",  "gyro z",
                                              "accel x", "accel y", "accel z"};

double AxisOf(const DoctorSample& s, int axis) {
  return axis < 3 ? s.gyro[axis] : s.accel[axis - 3];
}

/// Runs of equal values of one axis, in order of time.
struct Runs {
  std::int64_t repeats = 0;  ///< neighbours that are equal
  std::int64_t longest = 1;  ///< samples
  std::size_t longest_at = 0;
};

template <class Equal>
Runs RunsOf(std::size_t n, const Equal& equal_to_previous) {
  Runs runs;
  std::int64_t length = 1;
  for (std::size_t i = 1; i < n; ++i) {
    if (!equal_to_previous(i)) {
      length = 1;
      continue;
    }
    ++runs.repeats;
    if (++length > runs.longest) {
      runs.longest = length;
      runs.longest_at = i + 1 - Index(length);
    }
  }
  return runs;
}

/// The run that n samples would reach by chance once in a thousand recordings, where neighbours are
/// equal with the probability that these are. A sensor that is stuck half of the time must not
/// excuse itself: the probability that is believed has a limit.
double LongestByChance(const Runs& runs, std::size_t n, double most_believed) {
  const double repeats = static_cast<double>(runs.repeats - (runs.longest - 1));
  const double p = std::clamp(repeats / static_cast<double>(n), 1e-3, most_believed);
  return 2.0 + std::log(1e3 * static_cast<double>(n)) / -std::log(p);
}

bool ReportStuck(const Runs& runs, double by_chance, const char* sensor, DoctorCase* c) {
  if (!(static_cast<double>(runs.longest) > by_chance)) return false;
  const double from = c->imu[runs.longest_at].t;
  const double seconds = c->imu[runs.longest_at + Index(runs.longest) - 1].t - from;
  DoctorFinding& f =
      c->Add(DoctorKind::kImuStuck, DoctorSeverity::kError, sensor,
             Text("the same value in %lld samples in a row (%.4g s)",
                  static_cast<long long>(runs.longest), seconds),
             "a dead axis or a driver that repeats its last reading: treat this stretch as a gap");
  f.stamp_ns = c->Stamp(from);
  f.count = runs.longest;
  f.estimate = seconds;
  f.unit = "s";
  return true;
}

void CheckStuck(DoctorCase* c) {
  const std::vector<DoctorSample>& imu = c->imu;
  bool whole[2] = {};
  for (int sensor = 0; sensor < 2; ++sensor) {
    const Runs runs = RunsOf(imu.size(), [&](std::size_t i) {
      return sensor == 0 ? imu[i].gyro == imu[i - 1].gyro : imu[i].accel == imu[i - 1].accel;
    });
    whole[sensor] = ReportStuck(runs, LongestByChance(runs, imu.size(), 0.5),
                                sensor == 0 ? "gyro" : "accel", c);
  }
  for (int axis = 0; axis < 6; ++axis) {
    if (whole[axis / 3]) continue;
    const Runs runs = RunsOf(imu.size(), [&](std::size_t i) {
      return AxisOf(imu[i], axis) == AxisOf(imu[i - 1], axis);
    });
    ReportStuck(runs, LongestByChance(runs, imu.size(), 0.8), kAxes[Index(axis)], c);
  }
}

/// Readings that were written twice or more: a slower sensor, sampled and held.
void CheckRepeated(DoctorCase* c) {
  const std::vector<DoctorSample>& imu = c->imu;
  const Runs runs = RunsOf(imu.size(), [&](std::size_t i) {
    return imu[i].gyro == imu[i - 1].gyro && imu[i].accel == imu[i - 1].accel;
  });
  const double share =
      static_cast<double>(runs.repeats - (runs.longest - 1)) / static_cast<double>(imu.size() - 1);
  if (!(share > 0.2)) return;
  DoctorFinding& f =
      c->Add(DoctorKind::kImuRepeated, DoctorSeverity::kWarning, "imu",
             Text("%.0f %% of the samples repeat the one before in all six values", 100.0 * share),
             "the sensor is slower than the recording: keep one of each, and correct the rate");
  f.count = runs.repeats;
  f.estimate = share;
}

/// Where an axis stops: its extreme value comes again and again, in runs, and hardly anything lies
/// just before it.
void CheckSaturated(DoctorCase* c) {
  const std::vector<DoctorSample>& imu = c->imu;
  const auto n = static_cast<double>(imu.size());
  for (int axis = 0; axis < 6; ++axis) {
    std::vector<double> values, steps;
    for (const DoctorSample& s : imu)
      values.push_back(AxisOf(s, axis));
    for (std::size_t i = 1; i < values.size(); ++i)
      steps.push_back(std::abs(values[i] - values[i - 1]));
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double ends[2] = {*low, *high};
    std::vector<double> sorted = values;
    const double median = QuantileOf(&sorted, 0.5);
    const double typical_step = QuantileOf(&steps, 0.5);
    for (const double end : ends) {
      const double reach = std::abs(end - median);
      if (!(reach > 8.0 * typical_step && reach > 0.0)) continue;  // an axis that only has noise
      std::int64_t at = 0, near = 0, run = 0, longest = 0;
      std::size_t first = 0;
      for (std::size_t i = 0; i < values.size(); ++i) {
        const double below = std::abs(values[i] - end);
        if (below <= 1e-9 * reach) {
          if (at++ == 0) first = i;
          longest = std::max(longest, ++run);
        } else {
          run = 0;
          if (below < 0.01 * reach) ++near;
        }
      }
      if (!(longest >= 3 && at >= 5 && at > 2 * near)) continue;
      const double share = static_cast<double>(at) / n;
      DoctorFinding& f = c->Add(
          DoctorKind::kImuSaturated,
          share > 1e-3 ? DoctorSeverity::kError : DoctorSeverity::kWarning, kAxes[Index(axis)],
          Text("stops at %.5g in %lld samples (%.2g %%), up to %lld in a row", end,
               static_cast<long long>(at), 100.0 * share, static_cast<long long>(longest)),
          Text("choose a larger range of the sensor; set ImuBufferOptions::%s_range to this value",
               axis < 3 ? "gyro" : "accel"));
      f.stamp_ns = c->Stamp(imu[first].t);
      f.count = at;
      f.estimate = end;
      f.unit = axis < 3 ? "rad/s" : "m/s^2";
      // Against the chance that as many land there as just below.
      f.sigmas = static_cast<double>(at - near) / std::sqrt(static_cast<double>(at + near));
    }
  }
}

}  // namespace

void CheckImuValues(DoctorCase* c) {
  const DoctorInput& in = c->input;
  if (in.imu.empty()) {
    c->Add(DoctorKind::kNoImu, in.imu_noise ? DoctorSeverity::kError : DoctorSeverity::kInfo, "imu",
           in.imu_noise ? "an IMU is described, but there are no samples" : "there is no IMU",
           "only the cameras were checked");
    return;
  }
  std::int64_t bad[2] = {};
  std::int64_t first_bad[2] = {};
  for (const ImuSample& s : in.imu) {
    const bool good[2] = {Usable(s.gyro), Usable(s.accel)};
    for (int sensor = 0; sensor < 2; ++sensor) {
      if (!good[sensor] && bad[sensor]++ == 0) first_bad[sensor] = s.stamp_ns;
    }
    if (good[0] && good[1]) c->imu.push_back({c->Seconds(s.stamp_ns), s.gyro, s.accel});
  }
  for (int sensor = 0; sensor < 2; ++sensor) {
    if (bad[sensor] == 0) continue;
    DoctorFinding& f = c->Add(
        DoctorKind::kImuNotFinite, DoctorSeverity::kError, sensor == 0 ? "gyro" : "accel",
        Text("%lld samples are no numbers, or beyond %.0e", static_cast<long long>(bad[sensor]),
             kNoReading),
        "drop them (ImuBuffer refuses NaN); look for what the driver writes when a read fails");
    f.stamp_ns = first_bad[sensor];
    f.count = bad[sensor];
  }
}

void CheckImuRepetition(DoctorCase* c) {
  if (c->imu.size() < 20 || !(c->imu_dt > 0.0)) return;
  CheckStuck(c);
  CheckRepeated(c);
  CheckSaturated(c);
}

}  // namespace glissade::internal
