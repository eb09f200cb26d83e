// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The accelerometer where it is quietest reads gravity: units and magnitude.
#include <algorithm>
#include <cmath>

#include "window/doctor.h"

namespace glissade::internal {

namespace {

/// Mean and scatter of the specific force over one window.
struct Window {
  double magnitude = 0.0, scatter = 0.0;
};

std::vector<Window> WindowsOf(const std::vector<DoctorSample>& imu, double length) {
  std::vector<Window> windows;
  for (std::size_t begin = 0; begin < imu.size();) {
    std::size_t end = begin;
    Vector3 sum = Vector3::Zero();
    while (end < imu.size() && imu[end].t < imu[begin].t + length)
      sum += imu[end++].accel;
    const auto n = static_cast<double>(end - begin);
    const Vector3 mean = sum / n;
    double scatter = 0.0;
    for (std::size_t i = begin; i < end; ++i)
      scatter += (imu[i].accel - mean).squaredNorm();
    if (end - begin >= 5) windows.push_back({mean.norm(), scatter / n});
    begin = end;
  }
  return windows;
}

/// Median of the magnitudes of the first n windows, and its sigma.
struct Quiet {
  double accel = 0.0, sigma = 0.0;
};

Quiet QuietOf(const std::vector<Window>& windows, std::size_t n) {
  std::vector<double> magnitudes, deviations;
  for (std::size_t i = 0; i < n; ++i)
    magnitudes.push_back(windows[i].magnitude);
  Quiet quiet;
  quiet.accel = QuantileOf(&magnitudes, 0.5);
  for (const double m : magnitudes)
    deviations.push_back(std::abs(m - quiet.accel));
  // 1.25: of the median against the mean. A bias of 0.05 m/s^2 is nothing unusual.
  const double spread = 1.4826 * QuantileOf(&deviations, 0.5);
  quiet.sigma = std::hypot(1.25 * spread / std::sqrt(static_cast<double>(n)), 0.005 * quiet.accel);
  return quiet;
}

struct Unit {
  double factor;  ///< m/s^2
  const char* name;
};
constexpr Unit kUnits[] = {
    {9.80665, "g"}, {9.80665e-3, "mg"}, {0.3048, "ft/s^2"}, {0.01, "cm/s^2"}};

}  // namespace

void CheckGravity(DoctorCase* c) {
  const Vector3& g = c->input.gravity;
  const double magnitude = g.norm();
  if (!(magnitude > 0.0 && magnitude < 1e6)) {
    c->Add(DoctorKind::kGravity, DoctorSeverity::kError, "calibration",
           "the given gravity is zero or no number",
           "gravity is the acceleration of free fall in the world, (0, 0, -9.81) for z up");
    return;
  }
  if (g[2] > 0.5 * magnitude) {
    DoctorFinding& f = c->Add(
        DoctorKind::kGravity, DoctorSeverity::kWarning, "calibration",
        Text("the given gravity points along +z: (%.4g, %.4g, %.4g)", g[0], g[1], g[2]),
        "it is the acceleration of free fall, not what an accelerometer reads at rest; for z up, "
        "(0, 0, -9.81)");
    f.estimate = g[2];
    f.unit = "m/s^2";
  }
  if (c->imu.empty()) return;
  Vector3 sum = Vector3::Zero();
  for (const DoctorSample& s : c->imu)
    sum += s.accel;
  c->report.facts.mean_accel = sum / static_cast<double>(c->imu.size());

  std::vector<Window> windows = WindowsOf(c->imu, 0.5);
  if (windows.size() < 4) return;
  std::stable_sort(windows.begin(), windows.end(),
                   [](const Window& a, const Window& b) { return a.scatter < b.scatter; });
  // The quiet quarter has less acceleration that is not gravity's; of a motion that never rests,
  // all windows together know more.
  const Quiet quarter = QuietOf(windows, std::max<std::size_t>(windows.size() / 4, 4));
  const Quiet all = QuietOf(windows, windows.size());
  const double quiet = quarter.sigma < all.sigma ? quarter.accel : all.accel;
  const double sigma = std::min(quarter.sigma, all.sigma);
  c->report.facts.quiet_accel = quiet;

  // Free fall, or a sensor that is off, has no unit.
  for (const Unit& unit : kUnits) {
    const double ratio = quiet * unit.factor / magnitude;
    if (!(ratio > 0.85 && ratio < 1.15) || std::abs(unit.factor - 1.0) < 0.2) continue;
    c->accel_unit = unit.factor;
    DoctorFinding& f =
        c->Add(DoctorKind::kAccelUnits, DoctorSeverity::kError, "accel",
               Text("reads %.4g where it is quietest: in %s, not m/s^2", quiet, unit.name),
               Text("multiply by %.7g", unit.factor));
    f.estimate = magnitude / quiet;
    f.sigma = magnitude / quiet * sigma / quiet;
    f.sigmas = std::abs(magnitude - quiet) / sigma;
    f.unit = "m/s^2";
    return;
  }
  const double off = std::abs(quiet / magnitude - 1.0);
  const double sigmas = std::abs(quiet - magnitude) / sigma;
  if (!(off > 0.05 && sigmas > 5.0)) return;
  DoctorFinding& f = c->Add(
      DoctorKind::kGravity, off > 0.1 ? DoctorSeverity::kError : DoctorSeverity::kWarning, "accel",
      Text("reads %.4g m/s^2 where it is quietest, while gravity was given as %.4g", quiet,
           magnitude),
      "scale factor, a bias that should be calibrated, or the given gravity");
  f.estimate = quiet;
  f.sigma = sigma;
  f.sigmas = sigmas;
  f.unit = "m/s^2";
}

}  // namespace glissade::internal
