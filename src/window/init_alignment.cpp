// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/init_alignment.h"

#include <Eigen/Dense>
#include <cmath>

#include "glissade/base/validate.h"
#include "glissade/lie/so3.h"
#include "window/verdicts.h"

namespace glissade::internal {

InitVerdict InertialTerms::Cut(const InitializationInput& input) {
  noise_ = input.noise;
  noise_.gaps = ImuGaps::kInflate;
  ImuBuffer buffer({.max_gap_ns = input.noise.max_gap_ns});
  for (std::size_t k = 0; k < input.imu.size(); ++k) {
    const Status s = buffer.Add(input.imu[k]);
    if (s.code() == StatusCode::kNotFinite) {
      return Refusal(InitReason::kNotFinite, static_cast<double>(k), 0.0, "index of an IMU sample",
                     "");
    }
    if (!s.ok()) return InvalidInput(s);
  }
  intervals_.resize(input.frames.size() - 1);
  for (std::size_t k = 0; k + 1 < input.frames.size(); ++k) {
    const Status s =
        buffer.Between(input.frames[k].stamp_ns, input.frames[k + 1].stamp_ns, &intervals_[k]);
    if (!s.ok()) {
      const double span =
          input.imu.empty() ? 0.0
                            : SecondsBetween(input.imu.front().stamp_ns, input.imu.back().stamp_ns);
      InitVerdict verdict =
          Refusal(InitReason::kTooFewSamples, span,
                  SecondsBetween(input.frames.front().stamp_ns, input.frames.back().stamp_ns),
                  "the IMU samples do not cover the frames; their span", "s");
      return verdict;
    }
    if (intervals_[k].gaps > 0) {
      return Refusal(InitReason::kImuGap, 1e-9 * static_cast<double>(intervals_[k].largest_gap_ns),
                     1e-9 * static_cast<double>(input.noise.max_gap_ns), "time without a reading",
                     "s");
    }
  }
  return {};
}

Status InertialTerms::Integrate(const ImuBias& bias) {
  std::vector<ImuPreintegration> terms;
  for (const ImuInterval& interval : intervals_) {
    auto term = Preintegrate(interval.samples, bias, noise_);
    if (!term.ok()) return term.status();
    terms.push_back(*term);
  }
  terms_ = std::move(terms);
  return {};
}

Vector3 AlignGyroBias(const std::vector<ImuPreintegration>& terms, const std::vector<Pose>& T_v_b,
                      const ImuBiasPrior& prior, double sigma_rotation) {
  const Eigen::Vector3d lin = terms.front().imu.bg_lin;
  const double prior_weight = 1.0 / (prior.gyro_sigma * prior.gyro_sigma);
  Eigen::Vector3d dbg = Eigen::Vector3d::Zero();
  for (int iteration = 0; iteration < 3; ++iteration) {
    Eigen::Matrix3d H = prior_weight * Eigen::Matrix3d::Identity();
    Eigen::Vector3d g = prior_weight * (lin + dbg - prior.mean.bg);
    for (std::size_t k = 0; k < terms.size(); ++k) {
      const PreintegratedImu& imu = terms[k].imu;
      const Vector3 phi = imu.dq_dbg * Vector3(dbg);
      const Quaternion measured = imu.dq * so3::ExpQuaternion(phi);
      const Quaternion seen(T_v_b[k].q().conjugate() * T_v_b[k + 1].q());
      const Eigen::Vector3d r = so3::Log(Quaternion(measured.conjugate() * seen));
      const Eigen::Matrix3d J = -so3::Jr(phi) * imu.dq_dbg;
      const double weight =
          1.0 / (2.0 * sigma_rotation * sigma_rotation + terms[k].covariance(3, 3));
      H += weight * J.transpose() * J;
      g += weight * J.transpose() * r;
    }
    dbg -= H.ldlt().solve(g);
  }
  return lin + dbg;
}

namespace {

/// The body's positions but for start, speed and gravity, alpha; its derivative by the bias, A; and
/// the same of its velocity.
struct Integrals {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> alpha, velocity;
  std::vector<Eigen::Matrix3d> A, A_velocity;

  Integrals(const std::vector<ImuPreintegration>& terms, const std::vector<Eigen::Matrix3d>& R,
            const Eigen::Vector3d& lever) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();
    Eigen::Matrix3d dp = Eigen::Matrix3d::Zero(), dv = Eigen::Matrix3d::Zero();
    double now = 0.0;
    for (std::size_t k = 0; k < R.size(); ++k) {
      t.push_back(now);
      alpha.emplace_back(p + R[k] * lever);
      velocity.push_back(v);
      A.push_back(dp);
      A_velocity.push_back(dv);
      if (k == terms.size()) break;
      const PreintegratedImu& imu = terms[k].imu;
      p += v * imu.dt + R[k] * imu.dp;
      v += R[k] * imu.dv;
      dp += dv * imu.dt + R[k] * imu.dp_dba;
      dv += R[k] * imu.dv_dba;
      now += imu.dt;
    }
  }
};

}  // namespace

Alignment AlignLinear(const std::vector<ImuPreintegration>& terms, const std::vector<Pose>& T_v_r,
                      const Pose& T_b_r, bool metric, double sigma_centre,
                      const ImuBiasPrior& prior, double gravity) {
  // Unknowns: a 0, b 3, lambda dba 6, lambda 9, lambda g 10 (3, or 2 on the tangent plane of g).
  constexpr Eigen::Index kStart = 0, kSpeed = 3, kBias = 6, kLambda = 9, kGravity = 10;
  const std::size_t n = T_v_r.size();
  const Pose T_r_b = T_b_r.Inverse();
  std::vector<Eigen::Matrix3d> R(n);
  for (std::size_t k = 0; k < n; ++k)
    R[k] = T_v_r[k].R() * T_r_b.R();
  const Integrals x(terms, R, T_b_r.p());

  Alignment out;
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double lambda = 1.0;
  Eigen::Matrix<double, 13, 1> u;
  constexpr int kPasses = 6;  // the first with g of any length
  for (int pass = 0; pass < kPasses; ++pass) {
    const bool on_sphere = pass > 0;
    Eigen::Matrix<double, 3, 2> tangent = Eigen::Matrix<double, 3, 2>::Zero();
    if (on_sphere) {
      g *= gravity / g.norm();
      tangent.col(0) = g.unitOrthogonal();
      tangent.col(1) = g.normalized().cross(tangent.col(0));
    }
    Eigen::Matrix<double, 13, 13> H = Eigen::Matrix<double, 13, 13>::Zero();
    Eigen::Matrix<double, 13, 1> b = Eigen::Matrix<double, 13, 1>::Zero();
    for (std::size_t k = 0; k < n; ++k) {
      const double t = x.t[k], fall = 0.5 * t * t;
      Eigen::Matrix<double, 3, 13> J = Eigen::Matrix<double, 3, 13>::Zero();
      J.block<3, 3>(0, kStart).setIdentity();
      J.block<3, 3>(0, kSpeed) = t * Eigen::Matrix3d::Identity();
      J.block<3, 3>(0, kBias) = x.A[k];
      J.col(kLambda) = x.alpha[k];
      if (on_sphere) {
        J.col(kLambda) += fall * g;
        J.block<3, 2>(0, kGravity) = fall * tangent;
      } else {
        J.block<3, 3>(0, kGravity) = fall * Eigen::Matrix3d::Identity();
      }
      // What the accelerometer's noise has become by then.
      const double drift = std::abs(lambda) *
                           std::sqrt(t * terms.front().covariance(6, 6) / terms.front().imu.dt) * t;
      const double weight = 1.0 / (sigma_centre * sigma_centre + drift * drift / 3.0);
      H.noalias() += weight * J.transpose() * J;
      b.noalias() += weight * J.transpose() * Eigen::Vector3d(T_v_r[k].p());
    }
    // The prior of the bias, in units of V by the lambda of the last pass; in the first, none is
    // known, and without a prior bias and gravity may be one: then as if V were metric.
    const double sigma = prior.accel_sigma * (pass == 0 ? 1.0 : std::abs(lambda));
    const double weight = 1.0 / (sigma * sigma);
    H.diagonal().segment<3>(kBias).array() += weight;
    b.segment<3>(kBias) +=
        weight * lambda * Eigen::Vector3d(prior.mean.ba - terms.front().imu.ba_lin);
    const auto hold = [&](Eigen::Index k, double value) {
      b -= H.col(k) * value;
      H.row(k).setZero();
      H.col(k).setZero();
      H(k, k) = 1.0;
      b[k] = value;
    };
    if (metric) hold(kLambda, 1.0);
    if (on_sphere) hold(kGravity + 2, 0.0);
    // Columns of many sizes: to a unit diagonal.
    const Eigen::Matrix<double, 13, 1> d = H.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Eigen::Matrix<double, 13, 13>> ldlt(d.asDiagonal() * H * d.asDiagonal());
    u = d.cwiseProduct(ldlt.solve(d.cwiseProduct(b)));
    if (!AllFinite(u.data(), 13)) return out;
    lambda = u[kLambda];
    if (!(std::abs(lambda) > 0.0)) return out;
    if (on_sphere) {
      g += tangent * u.segment<2>(kGravity) / lambda;
    } else {
      g = u.segment<3>(kGravity) / lambda;
    }
    if (!(g.norm() > 0.0)) return out;
    Eigen::Matrix<double, 13, 1> unit = Eigen::Matrix<double, 13, 1>::Zero();
    unit[kLambda] = d[kLambda];
    const double variance = d[kLambda] * ldlt.solve(unit)[kLambda];
    if (!metric) out.relative_scale_sigma = std::sqrt(std::max(0.0, variance)) / std::abs(lambda);
  }
  out.gravity = gravity / g.norm() * g;
  out.scale = 1.0 / lambda;
  const Eigen::Vector3d dba = u.segment<3>(kBias) / lambda;
  out.ba = Eigen::Vector3d(terms.front().imu.ba_lin) + dba;
  for (std::size_t k = 0; k < n; ++k) {
    out.velocities.push_back(u.segment<3>(kSpeed) / lambda + x.t[k] * out.gravity + x.velocity[k] +
                             x.A_velocity[k] * dba);
  }
  out.ok = AllFinite(out.gravity.data(), 3) && AllFinite(out.ba.data(), 3) &&
           AllFinite(out.velocities.back().data(), 3);
  return out;
}

}  // namespace glissade::internal
