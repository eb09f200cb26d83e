// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// White noise of the IMU against the densities that were given.
#include <algorithm>
#include <cmath>

#include "window/doctor.h"

namespace glissade::internal {

namespace {

/// White noise in flight is what is left of a signal after it has been differenced three times: the
/// motion of a body is gone by then (1 rad/s at 1 Hz, sampled at 200 Hz, leaves 3e-5 rad/s), of
/// white noise of variance s^2 there is 20 s^2 (1 + 9 + 9 + 1).
constexpr double kThirdDifference = 20.0;
/// Third differences in a window.
constexpr std::size_t kWindow = 100;
/// Neighbouring third differences are correlated: 2 * 924 / 400 / n is the relative variance of
/// their mean square over n of them (924 = sum of squares of the autocorrelation's coefficients,
/// 400 = 20^2). A window's density has half of that sigma: 0.062 of it.
const double kWindowSigma = std::sqrt(0.5 * 924.0 / 400.0 / (3.0 * kWindow));

/// Density in one band, over windows.
struct Band {
  double quiet = 0.0;  ///< of the tenth part of the windows that is quietest
  double median = 0.0;
  int windows = 0;
};

/// Of means of `m` samples: their third differences are about a sixth to half of rate / m, so that
/// m chooses a band. White noise has one density in all.
Band MeasureBand(const DoctorCase& c, bool gyro, std::size_t m) {
  const std::vector<DoctorSample>& imu = c.imu;
  std::vector<Vector3> means;  // of the last regular stretch
  std::vector<double> densities;
  double sum = 0.0;
  std::size_t used = 0, in_mean = 0;
  Vector3 total = Vector3::Zero();
  for (std::size_t i = 1; i < imu.size(); ++i) {
    // Over a gap, or where stamps are not regular, differences are no differences.
    const double step = imu[i].t - imu[i - 1].t;
    if (!(step < 1.5 * c.imu_dt && step > 0.5 * c.imu_dt)) {
      means.clear();
      total.setZero();
      in_mean = 0;
      continue;
    }
    total += gyro ? imu[i].gyro : imu[i].accel;
    if (++in_mean < m) continue;
    means.push_back(total / static_cast<double>(m));
    total.setZero();
    in_mean = 0;
    const std::size_t n = means.size();
    if (n < 4) continue;
    sum += (means[n - 1] - means[n - 4] - 3.0 * (means[n - 2] - means[n - 3])).squaredNorm();
    if (++used < kWindow) continue;
    const double variance = sum / (3.0 * kWindow * kThirdDifference);
    densities.push_back(std::sqrt(variance * static_cast<double>(m) * c.imu_dt));
    sum = 0.0;
    used = 0;
  }
  Band band;
  band.windows = static_cast<int>(densities.size());
  if (band.windows < 4) return band;
  band.median = QuantileOf(&densities, 0.5);
  // The tenth part of a sample of windows lies 1.28 sigmas low.
  band.quiet = QuantileOf(&densities, 0.1) / (1.0 - 1.28 * kWindowSigma);
  return band;
}

struct Measured {
  double density = 0.0;  ///< where and in the band in which it is least
  double median = 0.0;   ///< over the recording, in that band
  /// The same in all bands, and at all times: noise of the sensor. Vibration of rotors and engines
  /// is neither.
  bool white = true;
  double relative_sigma = 0.0;
};

Measured Measure(const DoctorCase& c, bool gyro) {
  Measured result;
  double most = 0.0;
  for (const std::size_t m : {1u, 2u, 4u}) {
    const Band band = MeasureBand(c, gyro, m);
    if (band.windows < 4) continue;
    most = std::max(most, band.quiet);
    if (result.density > 0.0 && band.quiet >= result.density) continue;
    result.density = band.quiet;
    result.median = band.median;
    result.relative_sigma = 1.7 * kWindowSigma / std::sqrt(static_cast<double>(band.windows));
  }
  result.white = most < 1.5 * result.density && result.median < 1.5 * result.density;
  const double unit = gyro ? c.gyro_unit : c.accel_unit;
  result.density *= unit;
  result.median *= unit;
  return result;
}

void Compare(DoctorKind kind, const char* sensor, const char* unit, const Measured& m, double given,
             DoctorCase* c) {
  if (!(m.density > 0.0)) return;
  const double factor = m.density / given;
  const auto add = [&](DoctorSeverity severity, std::string message, const char* advice) {
    DoctorFinding& f = c->Add(kind, severity, sensor, std::move(message), advice);
    f.sigmas = std::abs(std::log(factor)) / m.relative_sigma;
    f.estimate = factor;
    f.sigma = factor * m.relative_sigma;
  };
  if (factor > 2.0 && m.white) {
    add(factor > 5.0 ? DoctorSeverity::kError : DoctorSeverity::kWarning,
        Text("white noise is %.3g %s, %.2g times the given %.3g: dangerous, the estimator trusts "
             "it too much",
             m.density, unit, factor, given),
        "raise the density to what is measured");
  } else if (factor < 0.2) {
    add(DoctorSeverity::kWarning,
        Text("white noise is %.3g %s, only %.2g times the given %.3g: safe, but accuracy is given "
             "away",
             m.density, unit, factor, given),
        "lower the density, not below twice what is measured: scale, misalignment and vibration "
        "are not in it");
  } else if (m.median > 3.0 * given) {
    add(DoctorSeverity::kInfo,
        Text("%.2g times the given density of %.3g %s at its quietest, %.2g times in the median, "
             "and not white: vibration",
             factor, given, unit, m.median / given),
        "raise the density if the estimate is overconfident in flight");
  }
}

}  // namespace

void CheckImuNoise(DoctorCase* c) {
  if (c->input.imu_noise) {
    if (const Status s = c->input.imu_noise->Validate(); !s.ok()) {
      c->Add(DoctorKind::kBadNoise, DoctorSeverity::kError, "imu", s.message(),
             "give noise densities and random walks as the data sheet or Kalibr has them");
    }
  }
  if (!(c->imu_dt > 0.0)) return;
  const Measured gyro = Measure(*c, true);
  const Measured accel = Measure(*c, false);
  c->report.facts.gyro_noise_density = gyro.density;
  c->report.facts.accel_noise_density = accel.density;
  if (!c->input.imu_noise || !c->input.imu_noise->Validate().ok()) return;
  Compare(DoctorKind::kGyroNoise, "gyro", "rad/s/sqrt(Hz)", gyro,
          c->input.imu_noise->gyro_noise_density, c);
  Compare(DoctorKind::kAccelNoise, "accel", "m/s^2/sqrt(Hz)", accel,
          c->input.imu_noise->accel_noise_density, c);
}

}  // namespace glissade::internal
