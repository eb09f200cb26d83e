// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/imu/imu_factor.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "glissade/lie/so3.h"

namespace glissade {

Status internal::SqrtInformation15(const double* covariance_data, double* sqrt_information) {
  const Eigen::Map<const SquareMatrix<15>> covariance(covariance_data);
  constexpr double kLeastPivot = 1e-13;
  if (!internal::AllFinite(covariance.data(), 225)) {
    return {StatusCode::kNotFinite, "IMU covariance is not finite"};
  }
  Vector<15> sigma;
  for (int k = 0; k < 15; ++k) {
    sigma[k] = std::sqrt(covariance(k, k));
    if (!(sigma[k] > 0.0)) {
      return {StatusCode::kNotPositive,
              "IMU covariance: variance " + std::to_string(k) + " is not positive"};
    }
  }
  // C = V V' with V upper triangular, from the last column to the first; U = V^-1 D^-1.
  SquareMatrix<15> V = SquareMatrix<15>::Zero();
  for (int j = 14; j >= 0; --j) {
    double pivot = 1.0;
    for (int k = j + 1; k < 15; ++k)
      pivot -= V(j, k) * V(j, k);
    if (!(pivot > kLeastPivot)) {
      return {StatusCode::kNotPositive,
              "IMU covariance is not positive definite (row " + std::to_string(j) + ")"};
    }
    V(j, j) = std::sqrt(pivot);
    for (int i = 0; i < j; ++i) {
      double x = covariance(i, j) / (sigma[i] * sigma[j]);
      for (int k = j + 1; k < 15; ++k)
        x -= V(i, k) * V(j, k);
      V(i, j) = x / V(j, j);
    }
  }
  SquareMatrix<15> U = SquareMatrix<15>::Zero();
  for (int j = 0; j < 15; ++j) {
    U(j, j) = 1.0 / V(j, j);
    for (int i = j - 1; i >= 0; --i) {
      double x = 0.0;
      for (int k = i + 1; k <= j; ++k)
        x += V(i, k) * U(k, j);
      U(i, j) = -x / V(i, i);
    }
  }
  for (int i = 0; i < 15; ++i) {
    for (int j = i; j < 15; ++j)
      U(i, j) /= sigma[j];
  }
  if (!internal::AllFinite(U.data(), 225)) {
    return {StatusCode::kNotFinite, "IMU information is not finite"};
  }
  std::copy_n(U.data(), 225, sqrt_information);
  return {};
}

Result<ImuFactor> MakeImuFactor(const ImuPreintegration& preintegration) {
  ImuFactor factor;
  factor.edge.imu = preintegration.imu;
  factor.gaps = preintegration.gaps;
  if (Status s = preintegration.imu.Validate(); !s.ok()) return s;
  SquareMatrix<15> U;
  if (Status s = SqrtInformationOf(preintegration.covariance, &U); !s.ok()) return s;
  factor.options.sqrt_information = U;
  return factor;
}

ImuPrediction Predict(const EdgeImu& edge, const VertexPose& pose_i,
                      const VertexSpeedBias& speed_bias_i) {
  const PreintegratedImu& imu = edge.imu;
  const double dt = imu.dt;
  const Vector3 dba = speed_bias_i.ba() - imu.ba_lin;
  const Vector3 dbg = speed_bias_i.bg() - imu.bg_lin;
  const Matrix3 R = pose_i.pose.R();
  const Vector3 dp = imu.dp + imu.dp_dba * dba + imu.dp_dbg * dbg;
  const Vector3 dv = imu.dv + imu.dv_dba * dba + imu.dv_dbg * dbg;
  const Quaternion dq = imu.dq * so3::ExpQuaternion(imu.dq_dbg * dbg);
  ImuPrediction next;
  next.speed_bias = speed_bias_i;
  next.speed_bias.v() = speed_bias_i.v() + dt * edge.gravity + R * dv;
  next.pose.pose.p() = pose_i.pose.p() + dt * (speed_bias_i.v() + 0.5 * dt * edge.gravity) + R * dp;
  next.pose.pose.q() = pose_i.pose.q() * dq;
  next.pose.pose.Normalize();
  return next;
}

}  // namespace glissade
