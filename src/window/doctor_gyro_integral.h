// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "glissade/lie/so3.h"
#include "window/doctor.h"

namespace glissade::internal {

/// Readings less bias in rad/s, integrated from the first on: as rotation, and as a plain sum for
/// where units are not known yet.
class GyroIntegral {
 public:
  GyroIntegral(const std::vector<DoctorSample>& imu, double unit, const Vector3& bias)
      : imu_(imu), unit_(unit), bias_(bias) {
    sums_.resize(imu.size(), Vector3::Zero());
    rotations_.resize(imu.size(), Matrix3::Identity());
    for (std::size_t k = 1; k < imu.size(); ++k) {
      const double h = imu[k].t - imu[k - 1].t;
      const Vector3 step = 0.5 * h * (Rate(k - 1) + Rate(k));
      sums_[k] = sums_[k - 1] + step;
      rotations_[k] = rotations_[k - 1] * so3::Exp(step);
    }
  }
  [[nodiscard]] bool Covers(double t0, double t1) const {
    return t0 >= imu_.front().t && t1 <= imu_.back().t;
  }
  [[nodiscard]] Vector3 SumAt(double t) const {
    Vector3 step;
    const std::size_t k = Before(t, &step);
    return sums_[k] + step;
  }
  [[nodiscard]] Matrix3 RotationAt(double t) const {
    Vector3 step;
    const std::size_t k = Before(t, &step);
    return rotations_[k] * so3::Exp(step);
  }
  [[nodiscard]] Vector3 Between(double t0, double t1) const {
    return so3::Log(Matrix3(RotationAt(t0).transpose() * RotationAt(t1)));
  }

 private:
  [[nodiscard]] Vector3 Rate(std::size_t k) const { return unit_ * imu_[k].gyro - bias_; }
  /// The sample before t, and the rotation from it to t (rates linear in between).
  std::size_t Before(double t, Vector3* step) const {
    const auto after =
        std::upper_bound(imu_.begin() + 1, imu_.end() - 1, t,
                         [](double time, const DoctorSample& s) { return time < s.t; });
    const auto k = static_cast<std::size_t>(after - imu_.begin()) - 1;
    const double h = imu_[k + 1].t - imu_[k].t;
    const double part = std::clamp((t - imu_[k].t) / h, 0.0, 1.0);
    *step = part * h * ((1.0 - 0.5 * part) * Rate(k) + 0.5 * part * Rate(k + 1));
    return k;
  }

  const std::vector<DoctorSample>& imu_;
  double unit_;
  Vector3 bias_;
  std::vector<Vector3> sums_;
  std::vector<Matrix3> rotations_;
};

}  // namespace glissade::internal
