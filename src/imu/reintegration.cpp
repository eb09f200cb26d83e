// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/imu/reintegration.h"

#include <cmath>

#include "glissade/lie/so3.h"

namespace glissade {

ImuIncrementError BiasCorrectionError(const ImuPreintegration& preintegration,
                                      const ImuBias& bias) {
  const PreintegratedImu& imu = preintegration.imu;
  const double dt = imu.dt, a = preintegration.mean_accel;
  const double dba = (bias.ba - imu.ba_lin).norm();
  const double turn = (bias.bg - imu.bg_lin).norm() * dt;  // rad
  ImuIncrementError error;
  error.v = turn * dt * (turn * a / 6.0 + dba / 2.0);
  error.p = turn * dt * dt * (turn * a / 24.0 + dba / 6.0);
  error.theta = turn * turn * so3::Log(imu.dq).norm() / 12.0;
  return error;
}

bool NeedsReintegration(const ImuPreintegration& preintegration, const ImuBias& bias,
                        double max_fraction) {
  const ImuIncrementError error = BiasCorrectionError(preintegration, bias);
  const auto limit = [&](int row) {
    return max_fraction *
           std::sqrt(preintegration.covariance.diagonal().segment<3>(row).sum() / 3.0);
  };
  // Written so that NaN asks for a new integration, which then says what is wrong.
  return !(error.p <= limit(0) && error.theta <= limit(3) && error.v <= limit(6));
}

}  // namespace glissade
