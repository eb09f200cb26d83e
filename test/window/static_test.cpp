// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "glissade/window/initialize_static.h"
#include "window/standing_imu.h"

namespace glissade {
namespace {

using test::StandingImu;

InitVerdict VerdictOf(std::span<const ImuSample> samples, const StaticOptions& options = {}) {
  InitVerdict verdict;
  const auto state = InitializeStatic(samples, ImuNoise(), options, &verdict);
  EXPECT_EQ(state.ok(), verdict.ok()) << state.status().message();
  EXPECT_EQ(state.status().message(), verdict.message);
  return verdict;
}

Matrix3 Attitude(sim::NoiseSource& random) {
  return so3::Exp(Vector3(random.Uniform(0.0, 3.1) * random.Direction()));
}

TEST(Static, ReturnsAttitudeAndGyroscopeBias) {
  StandingImu body;
  body.R_w_b = so3::Exp(Vector3(0.0, -0.4, 0.0)) * so3::Exp(Vector3(0.7, 0.0, 0.0));
  body.bias.bg = Vector3(0.02, -0.03, 0.078);
  const auto state = InitializeStatic(body.Read(ImuNoise()), ImuNoise());
  ASSERT_TRUE(state.ok()) << state.status().message();
  EXPECT_EQ(state->stamp_ns, 2'000'000'000);
  // Without an accelerometer bias only noise is left: 2e-3 / 9.81 rad.
  EXPECT_LT(so3::Log(Matrix3(body.R_w_b.transpose() * state->pose.pose.R())).norm(), 2e-3);
  EXPECT_LT((state->speed_bias.bg() - body.bias.bg).norm(), 2e-3);
  EXPECT_EQ(state->speed_bias.v().norm(), 0.0);
  // Yaw 0: the body's x axis has no part along y.
  EXPECT_NEAR(state->pose.pose.R()(1, 0), 0.0, 1e-12);
  EXPECT_GT(state->pose.pose.R()(0, 0), 0.0);
  EXPECT_LT((state->covariance - state->covariance.transpose()).norm(), 1e-15);
}

/// Tilt and accelerometer bias together, and the gyroscope's bias: the errors are as large as the
/// covariance says, whatever the attitude, with rotors off and on.
TEST(Static, CovarianceIsThatOfTheErrors) {
  for (const double shake : {0.0, 1.0}) {
    double nees_tilt_bias = 0.0, nees_gyro = 0.0;
    constexpr int kRuns = 200;
    StaticOptions options;
    options.bias_prior.accel_sigma = 0.15;
    options.bias_prior.gyro_sigma = 0.05;
    for (int run = 0; run < kRuns; ++run) {
      sim::NoiseSource random(static_cast<std::uint64_t>(run) + 1);
      StandingImu body;
      body.seed = static_cast<std::uint64_t>(run) + 1;
      body.R_w_b = Attitude(random);
      body.bias.ba = random.Normal3(options.bias_prior.accel_sigma);
      body.bias.bg = random.Normal3(options.bias_prior.gyro_sigma);
      body.shake_accel = shake;
      body.shake_gyro = 0.05 * shake;
      ImuBias at_end;
      const auto samples = body.Read(ImuNoise(), &at_end);
      const auto state = InitializeStatic(samples, ImuNoise(), options);
      ASSERT_TRUE(state.ok()) << run << ": " << state.status().message();

      // Truth turned about the vertical to the estimate's yaw: the error is then a pure tilt.
      const Matrix3 R = state->pose.pose.R();
      const Vector3 up = R.transpose() * Vector3::UnitZ(),
                    up_true = body.R_w_b.transpose() * Vector3::UnitZ();
      // R_true = R Exp(dtheta): up_true = up + up x dtheta, and with up' dtheta = 0,
      // dtheta = up_true x up.
      const Eigen::Vector3d tilt = up_true.cross(up);
      Eigen::Matrix<double, 5, 1> e;
      const Eigen::Vector3d axis_1 = Eigen::Vector3d(up).unitOrthogonal();
      const Eigen::Vector3d axis_2 = Eigen::Vector3d(up).cross(axis_1);
      e << axis_1.dot(tilt), axis_2.dot(tilt), at_end.ba - state->speed_bias.ba();
      Eigen::Matrix<double, 5, 15> P = Eigen::Matrix<double, 5, 15>::Zero();
      P.block<1, 3>(0, 3) = axis_1.transpose();
      P.block<1, 3>(1, 3) = axis_2.transpose();
      P.block<3, 3>(2, 9).setIdentity();
      const Eigen::Matrix<double, 5, 5> C =
          P * Eigen::Matrix<double, 15, 15>(state->covariance) * P.transpose();
      nees_tilt_bias += e.dot(C.ldlt().solve(e)) / kRuns;
      const Eigen::Vector3d g = at_end.bg - state->speed_bias.bg();
      nees_gyro += g.squaredNorm() / state->covariance(12, 12) / kRuns;
    }
    SCOPED_TRACE(shake);
    // Of 200 runs the mean has a sigma of sqrt(2 * 5 / 200) = 0.22, and sqrt(2 * 3 / 200) = 0.17.
    EXPECT_GT(nees_tilt_bias, 5.0 - 0.9);
    EXPECT_LT(nees_tilt_bias, 5.0 + 0.9);
    EXPECT_LT(nees_gyro, 3.0 + 0.7);
    if (shake == 0.0) {
      EXPECT_GT(nees_gyro, 3.0 - 0.7);
    }
  }
}

TEST(Static, RotorsOnPass) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    StandingImu body;
    body.seed = seed;
    body.shake_accel = 1.5;
    body.shake_gyro = 0.1;
    EXPECT_TRUE(VerdictOf(body.Read(ImuNoise())).ok()) << seed;
  }
}

TEST(Static, WhatMovesIsRefused) {
  const auto moved = [](auto&& add) {
    StandingImu body;
    auto samples = body.Read(ImuNoise());
    for (std::size_t k = 0; k < samples.size(); ++k)
      add(0.005 * static_cast<double>(k), samples[k]);
    return VerdictOf(samples).reason;
  };
  // A hand that lifts: 0.1 m/s in half a second.
  EXPECT_EQ(moved([](double t, ImuSample& s) { s.accel[2] += t > 0.5 ? 0.2 : 0.0; }),
            InitReason::kMoving);
  // Swaying by a degree, once a second.
  EXPECT_EQ(moved([](double t, ImuSample& s) { s.gyro[0] += 0.11 * std::cos(6.28 * t); }),
            InitReason::kMoving);
  // A turntable: far from any bias.
  EXPECT_EQ(moved([](double, ImuSample& s) { s.gyro[2] += 0.8; }), InitReason::kMoving);
  EXPECT_EQ(moved([](double, ImuSample& s) { s.accel *= 1.1; }), InitReason::kWrongGravity);
  EXPECT_EQ(moved([](double, ImuSample&) {}), InitReason::kOk);
}

TEST(Static, FalseAlarmsAreAsRareAsSaid) {
  StaticOptions options;
  options.stillness.false_alarm = 0.1;
  // Sensor noise alone, and a tremble that is all but excluded: the chi2 is then exact.
  options.stillness.tremble_angle = 1e-9;
  options.stillness.tremble_speed = 1e-9;
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    StandingImu body;
    body.seed = seed;
    const StillnessTest test = TestStillness(body.Read(ImuNoise()), ImuNoise(), options.stillness);
    alarms += test.gyro_chi2 > test.max_chi2 ? 1 : 0;
    alarms += test.accel_chi2 > test.max_chi2 ? 1 : 0;
  }
  // Binomial, 600 draws at 0.1: 60 +- 7.3.
  EXPECT_GT(alarms, 60 - 26);
  EXPECT_LT(alarms, 60 + 26);
}

TEST(Static, NothingNotFinitePasses) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (const std::size_t at : {std::size_t{0}, std::size_t{77}, std::size_t{200}}) {
      for (int axis = 0; axis < 6; ++axis) {
        auto samples = StandingImu().Read(ImuNoise());
        (axis < 3 ? samples[at].gyro[axis] : samples[at].accel[axis - 3]) = bad;
        const InitVerdict verdict = VerdictOf(samples);
        EXPECT_EQ(verdict.reason, InitReason::kNotFinite);
        EXPECT_EQ(verdict.figure, static_cast<double>(at));
      }
    }
  }
  // Finite, but not what a double can square.
  auto samples = StandingImu().Read(ImuNoise());
  for (ImuSample& s : samples)
    s.accel = Vector3::Constant(1e300);
  EXPECT_FALSE(VerdictOf(samples).ok());
}

TEST(Static, TooFewGapsAndStamps) {
  auto samples = StandingImu().Read(ImuNoise());
  EXPECT_EQ(VerdictOf({}).reason, InitReason::kTooFewSamples);
  EXPECT_EQ(VerdictOf(std::span(samples).first(1)).reason, InitReason::kTooFewSamples);
  const InitVerdict short_one = VerdictOf(std::span(samples).first(61));
  EXPECT_EQ(short_one.reason, InitReason::kTooFewSamples);
  EXPECT_NEAR(short_one.figure, 0.3, 1e-9);
  EXPECT_NE(short_one.message.find("0.3 s"), std::string::npos) << short_one.message;

  auto gap = samples;
  gap.erase(gap.begin() + 50, gap.begin() + 80);
  EXPECT_EQ(VerdictOf(gap).reason, InitReason::kImuGap);
  EXPECT_NEAR(VerdictOf(gap).figure, 0.155, 1e-9);
  auto few = samples;  // slow, but no gap: 20 Hz
  few.clear();
  for (std::size_t k = 0; k < samples.size(); k += 10)
    few.push_back(samples[k]);
  EXPECT_TRUE(VerdictOf(few).ok());
  auto swapped = samples;
  std::swap(swapped[10], swapped[11]);
  EXPECT_EQ(VerdictOf(swapped).reason, InitReason::kInvalidInput);
  auto saturated = samples;
  saturated[5].accel_saturated = true;
  EXPECT_EQ(VerdictOf(saturated).reason, InitReason::kImuSaturated);

  StaticOptions options;
  options.gravity = -1.0;
  EXPECT_EQ(VerdictOf(samples, options).reason, InitReason::kInvalidInput);
}

/// An IMU at constant velocity reads what one at rest reads. Images say which it is.
TEST(Static, ConstantVelocityNeedsImages) {
  const auto samples = StandingImu().Read(ImuNoise());
  WindowCamera camera;
  camera.fx = camera.fy = 460.0;
  camera.cx = 376.0;
  camera.cy = 240.0;
  for (const double px_per_s : {0.0, 10.0}) {
    sim::NoiseSource random(3);
    std::vector<std::vector<FrameObservation>> seen(10);
    for (int track = 0; track < 60; ++track) {
      const double u = random.Uniform(100, 600), v = random.Uniform(100, 400);
      for (std::size_t k = 0; k < seen.size(); ++k) {
        const bool outlier = random.Uniform(0.0, 1.0) < 0.01;
        seen[k].push_back({.track = track,
                           .u = u + 0.1 * px_per_s * static_cast<double>(k) + random.Normal(1.0) +
                                (outlier ? random.Uniform(-300.0, 300.0) : 0.0),
                           .v = v + random.Normal(1.0)});
      }
    }
    std::vector<FrameObservations> frames;
    for (std::size_t k = 0; k < seen.size(); ++k)
      frames.push_back({1'000'000'000 + 100'000'000 * static_cast<std::int64_t>(k), seen[k]});
    StaticOptions options;
    options.cameras = std::span(&camera, 1);
    options.frames = frames;
    const InitVerdict verdict = VerdictOf(samples, options);
    EXPECT_EQ(verdict.reason, px_per_s == 0.0 ? InitReason::kOk : InitReason::kMoving)
        << verdict.message;
    seen[3][5].u = std::nan("");  // counts against standing still, and nothing else happens
    EXPECT_EQ(VerdictOf(samples, options).reason, verdict.reason);
    seen[3][5].camera = 1;
    EXPECT_EQ(VerdictOf(samples, options).reason, InitReason::kInvalidInput);
  }
}

}  // namespace
}  // namespace glissade
