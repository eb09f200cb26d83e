// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "glissade/imu/preintegration.h"
#include "glissade/lie/so3.h"

namespace glissade::test {

/// Angular rate and specific force of a lively flight: up to 3 rad/s, 10 +- 5 m/s^2.
inline Vector3 GyroAt(double t) {
  return {1.5 * std::sin(3.0 * t), 2.0 * std::cos(2.3 * t + 0.4), 1.0 + 0.8 * std::sin(5.0 * t)};
}
inline Vector3 AccelAt(double t) {
  return {3.0 * std::cos(2.0 * t), 4.0 * std::sin(3.1 * t + 1.0), 9.8 + 2.0 * std::sin(4.0 * t)};
}

inline ImuSample SampleAt(std::int64_t stamp_ns) {
  const double t = 1e-9 * static_cast<double>(stamp_ns);
  return {.stamp_ns = stamp_ns, .gyro = GyroAt(t), .accel = AccelAt(t)};
}

/// n + 1 samples from t = 0 on.
inline std::vector<ImuSample> Samples(int n, std::int64_t period_ns) {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= n; ++k)
    samples.push_back(SampleAt(k * period_ns));
  return samples;
}

/// Biased by `bias`: integration at that bias undoes it.
inline std::vector<ImuSample> WithBias(std::vector<ImuSample> samples, const ImuBias& bias) {
  for (ImuSample& s : samples) {
    s.gyro += bias.bg;
    s.accel += bias.ba;
  }
  return samples;
}

struct Increments {
  Quaternion q = Quaternion::Identity();
  Vector3 v = Vector3::Zero(), p = Vector3::Zero();
};

/// Integrates dR = R [w]x, dv = R a, dp = v from 0 to t_end in `steps` steps of Runge-Kutta's
/// classical fourth order on quaternions: another method than the library's, on a fine grid.
template <class Gyro, class Accel>
Increments IntegrateFinely(const Gyro& gyro, const Accel& accel, double t_begin, double t_end,
                           int steps, Increments x = {}) {
  struct Rate {
    Eigen::Vector4d q;
    Vector3 v, p;
  };
  const auto rate = [&](double t, const Eigen::Vector4d& q, const Vector3& v) {
    const Eigen::Quaterniond qq(q[3], q[0], q[1], q[2]);
    const Vector3 w = gyro(t);
    const Eigen::Quaterniond wq(0.0, w[0], w[1], w[2]);
    return Rate{0.5 * (qq * wq).coeffs(), qq.normalized() * accel(t), v};
  };
  const double h = (t_end - t_begin) / steps;
  Eigen::Vector4d q = x.q.coeffs();
  for (int k = 0; k < steps; ++k) {
    const double t = t_begin + k * h;
    const Rate a = rate(t, q, x.v);
    const Rate b = rate(t + h / 2, q + h / 2 * a.q, x.v + h / 2 * a.v);
    const Rate c = rate(t + h / 2, q + h / 2 * b.q, x.v + h / 2 * b.v);
    const Rate d = rate(t + h, q + h * c.q, x.v + h * c.v);
    q = (q + h / 6 * (a.q + 2 * b.q + 2 * c.q + d.q)).normalized();
    x.p += h / 6 * (a.p + 2 * b.p + 2 * c.p + d.p);
    x.v += h / 6 * (a.v + 2 * b.v + 2 * c.v + d.v);
  }
  x.q = Quaternion(q[3], q[0], q[1], q[2]);
  return x;
}

}  // namespace glissade::test
