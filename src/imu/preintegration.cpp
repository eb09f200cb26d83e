// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/imu/preintegration.h"

#include <algorithm>
#include <string>

#include "glissade/lie/so3.h"

namespace glissade {

namespace {

/// One step h in the axes of its beginning: increments and their derivatives by the biases, which
/// for a noise that is constant over the step are those by the noise.
struct Step {
  Vector3 phi;       // rotation vector
  Matrix3 R, Jr;     // Exp(phi), its right Jacobian
  Vector3 dv, dp;    // int E a dt, int (h - t) E a dt
  Matrix3 dphi_dbg;  // of phi
  Matrix3 dv_dba, dv_dbg, dp_dba, dp_dbg;
};

Step Integrate(const Vector3& w0, const Vector3& a0, const Vector3& w1, const Vector3& a1,
               double h) {
  Step s;
  const Vector3 cross = w0.cross(w1);
  const Vector3 a_mid = 0.5 * (a0 + a1);
  // Magnus series over the whole step and over its first half.
  const Vector3 phi_mid = h / 8.0 * (3.0 * w0 + w1) + h * h / 96.0 * cross;
  s.phi = 0.5 * h * (w0 + w1) + h * h / 12.0 * cross;
  s.R = so3::Exp(s.phi);
  s.Jr = so3::Jr(s.phi);
  const Matrix3 R_mid = so3::Exp(phi_mid);
  // Simpson's rule.
  const Vector3 f_mid = R_mid * a_mid;
  const Vector3 f_end = s.R * a1;
  s.dv = h / 6.0 * (a0 + 4.0 * f_mid + f_end);
  s.dp = h * h / 6.0 * (a0 + 2.0 * f_mid);
  // (w0 - d) x (w1 - d) = w0 x w1 + (w1 - w0) x d.
  const Matrix3 turn = so3::Hat(w1 - w0);
  s.dphi_dbg = -h * Matrix3::Identity() + h * h / 12.0 * turn;
  const Matrix3 dphi_mid_dbg = -0.5 * h * Matrix3::Identity() + h * h / 96.0 * turn;
  const Matrix3 df_mid_dbg = -(R_mid * so3::Hat(a_mid) * so3::Jr(phi_mid) * dphi_mid_dbg);
  const Matrix3 df_end_dbg = -(s.R * so3::Hat(a1) * s.Jr * s.dphi_dbg);
  s.dv_dbg = h / 6.0 * (4.0 * df_mid_dbg + df_end_dbg);
  s.dp_dbg = h * h / 3.0 * df_mid_dbg;
  s.dv_dba = -h / 6.0 * (Matrix3::Identity() + 4.0 * R_mid + s.R);
  s.dp_dba = -h * h / 6.0 * (Matrix3::Identity() + 2.0 * R_mid);
  return s;
}

/// How a step carries the error state [p, theta, v | ba, bg]: rows p, theta, v of
///
///     A = [ I  dp_dtheta      h I | dp_dba  dp_dbg     ]
///         [ 0  dtheta_dtheta  0   | 0       dtheta_dbg ]
///         [ 0  dv_dtheta      I   | dv_dba  dv_dbg     ]
///
/// those of the biases are [0 I]; the last six columns are also what white noise does.
struct ErrorStep {
  double h;
  Matrix3 dp_dtheta, dtheta_dtheta, dv_dtheta;
  Matrix3 dp_dba, dp_dbg, dtheta_dbg, dv_dba, dv_dbg;

  /// P <- A P A' + B Q B', by the blocks that are not zero.
  void Propagate(double accel_variance, double gyro_variance, SquareMatrix<15>* covariance) const {
    SquareMatrix<15>& P = *covariance;
    Matrix<3, 15> p, theta, v;  // rows of A P
    p = P.topRows<3>() + h * P.middleRows<3>(6);
    p.noalias() += dp_dtheta.lazyProduct(P.middleRows<3>(3));
    p.noalias() += dp_dba.lazyProduct(P.middleRows<3>(9));
    p.noalias() += dp_dbg.lazyProduct(P.middleRows<3>(12));
    theta.noalias() = dtheta_dtheta.lazyProduct(P.middleRows<3>(3));
    theta.noalias() += dtheta_dbg.lazyProduct(P.middleRows<3>(12));
    v = P.middleRows<3>(6);
    v.noalias() += dv_dtheta.lazyProduct(P.middleRows<3>(3));
    v.noalias() += dv_dba.lazyProduct(P.middleRows<3>(9));
    v.noalias() += dv_dbg.lazyProduct(P.middleRows<3>(12));
    // What noise adds is like a bias that nothing else knows of.
    const auto ba = [&](const Matrix<3, 15>& rows, const Matrix3& by) -> Matrix3 {
      return rows.middleCols<3>(9) + accel_variance * by;
    };
    const auto bg = [&](const Matrix<3, 15>& rows, const Matrix3& by) -> Matrix3 {
      return rows.middleCols<3>(12) + gyro_variance * by;
    };
    const Matrix3 p_ba = ba(p, dp_dba), p_bg = bg(p, dp_dbg), theta_bg = bg(theta, dtheta_dbg),
                  v_ba = ba(v, dv_dba), v_bg = bg(v, dv_dbg);
    const Matrix3 pp = p.leftCols<3>() + h * p.middleCols<3>(6) +
                       p.middleCols<3>(3) * dp_dtheta.transpose() + p_ba * dp_dba.transpose() +
                       p_bg * dp_dbg.transpose();
    const Matrix3 theta_p = theta.leftCols<3>() + h * theta.middleCols<3>(6) +
                            theta.middleCols<3>(3) * dp_dtheta.transpose() +
                            theta.middleCols<3>(9) * dp_dba.transpose() +
                            theta_bg * dp_dbg.transpose();
    const Matrix3 theta_theta =
        theta.middleCols<3>(3) * dtheta_dtheta.transpose() + theta_bg * dtheta_dbg.transpose();
    const Matrix3 v_p = v.leftCols<3>() + h * v.middleCols<3>(6) +
                        v.middleCols<3>(3) * dp_dtheta.transpose() + v_ba * dp_dba.transpose() +
                        v_bg * dp_dbg.transpose();
    const Matrix3 v_theta =
        v.middleCols<3>(3) * dtheta_dtheta.transpose() + v_bg * dtheta_dbg.transpose();
    const Matrix3 v_v = v.middleCols<3>(6) + v.middleCols<3>(3) * dv_dtheta.transpose() +
                        v_ba * dv_dba.transpose() + v_bg * dv_dbg.transpose();
    P.topRightCorner<3, 6>() = p.rightCols<6>();
    P.block<3, 6>(3, 9) = theta.rightCols<6>();
    P.block<3, 6>(6, 9) = v.rightCols<6>();
    P.bottomLeftCorner<6, 9>() = P.topRightCorner<9, 6>().transpose();
    P.block<3, 3>(0, 0) = 0.5 * (pp + pp.transpose());
    P.block<3, 3>(3, 0) = theta_p;
    P.block<3, 3>(0, 3) = theta_p.transpose();
    P.block<3, 3>(3, 3) = 0.5 * (theta_theta + theta_theta.transpose());
    P.block<3, 3>(6, 0) = v_p;
    P.block<3, 3>(0, 6) = v_p.transpose();
    P.block<3, 3>(6, 3) = v_theta;
    P.block<3, 3>(3, 6) = v_theta.transpose();
    P.block<3, 3>(6, 6) = 0.5 * (v_v + v_v.transpose());
  }
};

bool Finite(const ImuPreintegration& x) {
  return x.imu.Validate().ok() && internal::AllFinite(x.covariance.data(), 225) &&
         internal::AllFinite(&x.mean_accel, 1);
}

/// A step in a gap: the mean of what specific force and angular rate differ by from linear between
/// the ends, taken as constant over the step.
struct Unseen {
  std::int64_t gap_ns = 0;  ///< whole length; 0: no gap
  double accel = 0.0;       ///< variance per axis, (m/s^2)^2
  double gyro = 0.0;        ///< (rad/s)^2

  Unseen(const ImuSample& a, const ImuSample& b, const ImuNoise& noise) {
    const std::int64_t step_ns = NanosecondsBetween(a.stamp_ns, b.stamp_ns);
    const std::int64_t over_ns =
        std::max({step_ns, a.interpolated_over_ns, b.interpolated_over_ns});
    if (over_ns <= noise.max_gap_ns) return;
    gap_ns = over_ns;
    // Of a random walk held at both ends of T: its mean over T has variance T / 12. Over a part, an
    // end of which was interpolated, at most what it has in the middle, T / 4.
    const double T = 1e-9 * static_cast<double>(gap_ns);
    const double part = step_ns == gap_ns ? T / 12.0 : T / 4.0;
    accel = noise.gap_accel_walk * noise.gap_accel_walk * part;
    gyro = noise.gap_gyro_walk * noise.gap_gyro_walk * part;
  }
};

Status CheckSample(const ImuSample& sample) {
  if (Status s = ValidateFinite(sample.gyro.data(), 3, "gyroscope"); !s.ok()) return s;
  return ValidateFinite(sample.accel.data(), 3, "accelerometer");
}

}  // namespace

Status ImuPreintegrator::Start(const ImuSample& first, const ImuBias& bias, const ImuNoise& noise) {
  started_ = false;
  integral_ = ImuPreintegration{};
  if (Status s = noise.Validate(); !s.ok()) return s;
  if (Status s = CheckSample(first); !s.ok()) return s;
  if (Status s = ValidateFinite(bias.ba.data(), 3, "accelerometer bias"); !s.ok()) return s;
  if (Status s = ValidateFinite(bias.bg.data(), 3, "gyroscope bias"); !s.ok()) return s;
  noise_ = noise;
  last_ = first;
  integral_.imu.ba_lin = bias.ba;
  integral_.imu.bg_lin = bias.bg;
  started_ = true;
  return {};
}

Status ImuPreintegrator::Add(const ImuSample& sample) {
  if (!started_) return {StatusCode::kInvalidArgument, "preintegration has not been started"};
  if (Status s = CheckSample(sample); !s.ok()) return s;
  if (sample.stamp_ns <= last_.stamp_ns) {
    return {StatusCode::kInvalidArgument, "IMU sample at " + std::to_string(sample.stamp_ns) +
                                              " ns is not later than the one before"};
  }
  const Unseen unseen(last_, sample, noise_);
  if (unseen.gap_ns > 0 && noise_.gaps == ImuGaps::kRefuse) {
    return {StatusCode::kInvalidArgument,
            "no IMU reading for " + std::to_string(unseen.gap_ns) + " ns, between " +
                std::to_string(last_.stamp_ns) + " and " + std::to_string(sample.stamp_ns) +
                " ns: gaps of more than " + std::to_string(noise_.max_gap_ns) + " ns are refused"};
  }
  const double h = SecondsBetween(last_.stamp_ns, sample.stamp_ns);
  const PreintegratedImu& x = integral_.imu;
  const Vector3 a0 = last_.accel - x.ba_lin;
  const Vector3 a1 = sample.accel - x.ba_lin;
  const Step s = Integrate(last_.gyro - x.bg_lin, a0, sample.gyro - x.bg_lin, a1, h);
  const Matrix3 R = RotationMatrix(x.dq.coeffs().data());

  ImuPreintegration next = integral_;
  PreintegratedImu& y = next.imu;
  const Vector3 step_v = R * s.dv;
  const Vector3 step_p = R * s.dp;
  y.dt = x.dt + h;
  y.dq = (x.dq * so3::ExpQuaternion(s.phi)).normalized();
  y.dv = x.dv + step_v;
  y.dp = x.dp + h * x.dv + step_p;

  // Bias Jacobians by the same recursion as the errors: Exp(s.phi) carries a perturbation at the
  // right of dq to the new end.
  const Matrix3 dtheta_dbg_step = s.Jr * s.dphi_dbg;
  const Matrix3 dv_dtheta = -(R * so3::Hat(s.dv));
  const Matrix3 dp_dtheta = -(R * so3::Hat(s.dp));
  y.dp_dba = x.dp_dba + h * x.dv_dba + R * s.dp_dba;
  y.dp_dbg = x.dp_dbg + h * x.dv_dbg + dp_dtheta * x.dq_dbg + R * s.dp_dbg;
  y.dv_dba = x.dv_dba + R * s.dv_dba;
  y.dv_dbg = x.dv_dbg + dv_dtheta * x.dq_dbg + R * s.dv_dbg;
  y.dq_dbg = s.R.transpose() * x.dq_dbg + dtheta_dbg_step;

  // Error state e = [p, theta, v | ba, bg], Eq. (62): e <- A e + B n. The biases of the error state
  // are the distance walked since the start of the interval. A bias that has walked by w makes the
  // true increments those at bias + w, and so does noise of -w: one matrix for both.
  ErrorStep e;
  e.h = h;
  e.dp_dtheta = dp_dtheta;
  e.dtheta_dtheta = s.R.transpose();
  e.dv_dtheta = dv_dtheta;
  e.dp_dba = R * s.dp_dba;
  e.dp_dbg = R * s.dp_dbg;
  e.dtheta_dbg = dtheta_dbg_step;
  e.dv_dba = R * s.dv_dba;
  e.dv_dbg = R * s.dv_dbg;

  const double na =
      noise_.accel_noise_density *
      (last_.accel_saturated || sample.accel_saturated ? noise_.saturation_inflation : 1.0);
  const double ng =
      noise_.gyro_noise_density *
      (last_.gyro_saturated || sample.gyro_saturated ? noise_.saturation_inflation : 1.0);
  e.Propagate(na * na / h + unseen.accel, ng * ng / h + unseen.gyro, &next.covariance);
  // White noise is not constant over the step: the variance of its double integral is h^3 / 3, not
  // h^3 / 4. Keeps the covariance regular from the first step on.
  next.covariance.diagonal().segment<3>(0).array() += na * na * h * h * h / 12.0;
  if (unseen.gap_ns > 0) {
    // Nor is the walk in a gap: T^5 / 45, not T^5 / 48.
    next.covariance.diagonal().segment<3>(0).array() += unseen.accel * h * h * h * h / 60.0;
    ++next.gaps.count;
    next.gaps.longest_ns = std::max(next.gaps.longest_ns, unseen.gap_ns);
    next.gaps.bridged_s += h;
  }
  const double wa = noise_.accel_random_walk, wg = noise_.gyro_random_walk;
  next.covariance.diagonal().segment<3>(9).array() += wa * wa * h;
  next.covariance.diagonal().segment<3>(12).array() += wg * wg * h;
  next.mean_accel = (x.dt * integral_.mean_accel + 0.5 * h * (a0.norm() + a1.norm())) / y.dt;

  if (!Finite(next)) {
    return {StatusCode::kNotFinite,
            "preintegration overflows at " + std::to_string(sample.stamp_ns) + " ns"};
  }
  integral_ = next;
  last_ = sample;
  return {};
}

Result<ImuPreintegration> Preintegrate(std::span<const ImuSample> samples, const ImuBias& bias,
                                       const ImuNoise& noise) {
  if (samples.size() < 2) {
    return Status(StatusCode::kInvalidArgument, "preintegration needs at least two samples");
  }
  ImuPreintegrator integrator;
  Status status = integrator.Start(samples[0], bias, noise);
  for (std::size_t k = 1; k < samples.size() && status.ok(); ++k)
    status = integrator.Add(samples[k]);
  if (!status.ok()) return status;
  return integrator.Get();
}

}  // namespace glissade
