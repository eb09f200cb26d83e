// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What the gyroscope against the rotations of the cameras says: units, axes, T_b_c, time offset.
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "glissade/base/index.h"
#include "glissade/lie/so3.h"
#include "window/doctor.h"
#include "window/doctor_gyro_fit.h"

namespace glissade::internal {

namespace {

/// The axes of the body that the three of a sensor are, with their signs: the signed permutation
/// nearest to A, where a reading is A times the truth. Turned through less than 15 degrees, or
/// none.
std::optional<Matrix3> AxesOf(const Matrix3& A) {
  Matrix3 P = Matrix3::Zero();
  for (int row = 0; row < 3; ++row) {
    int column = 0;
    A.row(row).cwiseAbs().maxCoeff(&column);
    P(row, column) = A(row, column) < 0.0 ? -1.0 : 1.0;
  }
  const Matrix3 rest = P.transpose() * A;
  if (std::abs(std::abs(P.determinant()) - 1.0) > 0.5 || rest.determinant() < 0.0) return {};
  if (so3::Log(rest).norm() > 15.0 * kDegree) return {};
  return P;
}

/// "y, -x, z".
std::string NameOf(const Matrix3& P) {
  std::string name;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (P(row, column) == 0.0) continue;
      name.append(row > 0 ? ", " : "").append(P(row, column) < 0.0 ? "-" : "");
      name.push_back("xyz"[column]);
    }
  }
  return name;
}

/// The worst of the sigmas of the three angles, deg.
double AngleSigma(const GyroFit& fit) {
  return std::sqrt(fit.covariance.topLeftCorner<3, 3>().diagonal().maxCoeff()) / kDegree;
}

void ReportUnits(const GyroFit& fit, DoctorCase* c) {
  const double sigma = std::sqrt(fit.covariance(7, 7));
  if (fit.unit != 1.0) {
    c->gyro_unit = fit.unit;
    DoctorFinding& f = c->Add(
        DoctorKind::kGyroUnits, DoctorSeverity::kError, "gyro",
        Text("the camera rotates %.4g times what the gyroscope says: readings are in %s",
             fit.unit * fit.scale, fit.unit < 1.0 ? "deg/s" : "rad/s times 57.3 (divided twice?)"),
        Text("multiply by %.7g", fit.unit));
    f.estimate = fit.unit * fit.scale;
    f.sigma = fit.unit * fit.scale * sigma;
    f.sigmas = std::abs(std::log(fit.unit * fit.scale)) / sigma;
  }
  const double off = std::abs(std::log(fit.scale));
  if (!(off > 0.04 && off > 5.0 * sigma)) return;
  DoctorFinding& f =
      c->Add(DoctorKind::kGyroScale, off > 0.15 ? DoctorSeverity::kError : DoctorSeverity::kWarning,
             Text("gyro"),
             Text("the camera rotates %.4g times what the gyroscope says", fit.unit * fit.scale),
             "focal length of another resolution, or the gyroscope's scale factor");
  f.estimate = fit.scale;
  f.sigma = fit.scale * sigma;
  f.sigmas = off / sigma;
}

/// Axes of the gyroscope, or a rotation of T_b_c: one of the two.
void ReportRotation(const GyroFit& fit, int camera, DoctorCase* c) {
  const Matrix3 given = c->input.cameras[Index(camera)].T_b_c.R();
  const Matrix3 D = fit.R_b_c * given.transpose();
  const Vector3 d = so3::Log(D);
  if (camera == 0 && fit.sign > 0.0) c->report.facts.extrinsic_error = d;
  const Matrix3 covariance = fit.covariance.topLeftCorner<3, 3>();
  const double sigmas = std::sqrt(std::max(d.dot(covariance.inverse() * d), 0.0));
  const double angle = d.norm() / kDegree;
  const auto axes = AxesOf(fit.sign * D);
  if (axes && (fit.sign < 0.0 || angle > 20.0)) {
    if (sigmas < 5.0 && fit.sign > 0.0) return;
    if (c->report.Find(DoctorKind::kGyroAxes) != nullptr) return;  // the other camera said so, too
    DoctorFinding& f = c->Add(
        DoctorKind::kGyroAxes, DoctorSeverity::kError, "gyro",
        Text("its x, y, z are the body's %s, as camera %d sees it", NameOf(*axes).c_str(), camera),
        fit.sign < 0.0 ? "one axis has the wrong sign, or two are exchanged: no T_b_c can do that"
                       : "put them in order; or T_b_c is wrong by this rotation: the accelerometer "
                         "tells (gravity must stay where it is when the body turns)");
    f.sigmas = sigmas;
    f.estimate = angle;
    f.sigma = AngleSigma(fit);
    f.unit = "deg";
    return;
  }
  // What motion leaves open has a large sigma: an angle is named where it is known.
  if (!(sigmas > 5.0 && angle > 1.0)) return;
  const Vector3 deg = d / kDegree;
  DoctorFinding& f = c->Add(
      DoctorKind::kExtrinsicRotation,
      angle > 3.0 ? DoctorSeverity::kError : DoctorSeverity::kWarning, Text("camera %d", camera),
      Text("T_b_c is off by a rotation of %.3g deg, (%.2f, %.2f, %.2f) about the body's axes",
           angle, deg[0], deg[1], deg[2]),
      "R_b_c = Exp(that) times the given one; calibrate, or check which way round T_b_c is");
  f.sigmas = sigmas;
  f.estimate = angle;
  f.sigma = AngleSigma(fit);
  f.unit = "deg";
}

void ReportTimeOffset(double S, double sigma, DoctorCase* c) {
  c->report.facts.time_offset_s = S;
  c->report.facts.time_offset_sigma_s = sigma;
  const double size = std::abs(S);
  if (!(size > 0.003 && size > 5.0 * sigma)) return;
  DoctorFinding& f = c->Add(
      DoctorKind::kTimeOffset, size > 0.01 ? DoctorSeverity::kError : DoctorSeverity::kWarning,
      "cameras",
      Text("camera stamps are %.1f ms %s against the IMU", 1e3 * size, S < 0.0 ? "late" : "early"),
      Text("add %+.4f s to camera stamps (--time-offset %.4f)", S, S));
  f.sigmas = size / sigma;
  f.estimate = S;
  f.sigma = sigma;
  f.unit = "s";
}

void ReportNotComparable(const GyroFit& fit, DoctorCase* c) {
  const bool moves = fit.rotation_rms > 5.0 * fit.noise_rms;
  if (fit.pairs < 10) {
    c->Add(DoctorKind::kNotComparable, DoctorSeverity::kInfo, "cameras, gyro",
           Text("only %d pairs of images have a rotation and the IMU's readings to it", fit.pairs),
           "axes, T_b_c and time offset were not checked");
  } else if (moves) {
    DoctorFinding& f = c->Add(
        DoctorKind::kNotComparable, DoctorSeverity::kError, "cameras, gyro",
        Text(
            "their rotations have nothing in common at any offset within %.2g s (correlation %.2f)",
            c->options.max_time_offset_s, fit.correlation),
        "another recording's file, clocks further apart, or a dead gyroscope");
    f.estimate = fit.correlation;
  } else {
    c->Add(DoctorKind::kNotComparable, DoctorSeverity::kInfo, "cameras, gyro",
           Text("the cameras rotate too little (%.2g mrad in a pair, known to %.2g)",
                1e3 * fit.rotation_rms, 1e3 * fit.noise_rms),
           "axes, T_b_c and time offset were not checked: turn about all axes for some seconds");
  }
}

}  // namespace

void CheckGyroAgainstTracks(DoctorCase* c) {
  if (c->imu.empty() || c->pairs.empty()) return;
  double information = 0.0, sum = 0.0;
  std::optional<GyroFit> failed;
  for (int camera = 0; Index(camera) < c->camera_ok.size(); ++camera) {
    const GyroFit fit = FitGyroToPairs(*c, camera);
    if (!fit.ok) {
      if (!failed) failed = fit;
      continue;
    }
    if (c->gyro_unit == 1.0) ReportUnits(fit, c);
    ReportRotation(fit, camera, c);
    if (!c->report.facts.gyro_bias) c->report.facts.gyro_bias = fit.bias;
    const double weight = 1.0 / fit.covariance(3, 3);
    information += weight;
    sum += weight * fit.time_offset_s;
  }
  if (information > 0.0) {
    ReportTimeOffset(sum / information, 1.0 / std::sqrt(information), c);
  } else if (failed) {
    ReportNotComparable(*failed, c);
  }
}

}  // namespace glissade::internal
