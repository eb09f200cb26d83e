// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/doctor_gyro_correlation.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace glissade::internal {

GyroCorrelation CorrelationAt(const GyroIntegral& gyro, const std::vector<DoctorPair>& pairs,
                              double S) {
  // A constant rate is removed from both: it may be the bias.
  Vector3 sum_b = Vector3::Zero(), sum_c = Vector3::Zero();
  double sum_tt = 0.0;
  std::vector<Vector3> body;
  std::vector<const DoctorPair*> used;
  for (const DoctorPair& p : pairs) {
    if (!gyro.Covers(p.t0 + S, p.t1 + S)) continue;
    const double dt = p.t1 - p.t0;
    body.push_back(gyro.SumAt(p.t1 + S) - gyro.SumAt(p.t0 + S));
    used.push_back(&p);
    sum_b += dt * body.back();
    sum_c += dt * p.phi;
    sum_tt += dt * dt;
  }
  GyroCorrelation r;
  if (used.size() < 10) return r;
  double bb = 0.0, cc = 0.0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const double dt = used[i]->t1 - used[i]->t0;
    const Vector3 b = body[i] - dt / sum_tt * sum_b, v = used[i]->phi - dt / sum_tt * sum_c;
    r.M += b * v.transpose();
    bb += b.squaredNorm();
    cc += v.squaredNorm();
  }
  r.camera_rms = std::sqrt(cc / static_cast<double>(used.size()));
  const double norm = std::sqrt(bb * cc);
  if (!(norm > 0.0) || !std::isfinite(norm)) return r;
  r.M /= norm;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r.M);
  if (svd.info() != Eigen::Success) return r;
  const auto& s = svd.singularValues();
  const double last = r.M.determinant() < 0.0 ? -s[2] : s[2];
  r.proper = s[0] + s[1] + last;
  r.mirrored = s[0] + s[1] - last;
  r.scale = std::sqrt(cc / bb);
  return r;
}

}  // namespace glissade::internal
