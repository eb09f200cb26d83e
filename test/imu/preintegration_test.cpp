// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/imu/preintegration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "imu/imu_signal.h"

namespace glissade {
namespace {

using test::Increments;
using test::IntegrateFinely;
using test::Samples;

struct Difference {
  double p, theta, v;
};

Difference Compare(const PreintegratedImu& imu, const Increments& truth) {
  return {(imu.dp - truth.p).norm(), so3::Log(Quaternion(imu.dq.conjugate() * truth.q)).norm(),
          (imu.dv - truth.v).norm()};
}

TEST(Preintegration, AgreesWithFineIntegrationOfWhatWasSampled) {
  // 0.5 s at 200 Hz; between samples the signal is linear.
  const auto samples = Samples(100, 5'000'000);
  const auto at = [&](double t) {
    const auto k = std::min<std::size_t>(static_cast<std::size_t>(t / 0.005), 99);
    return Interpolate(samples[k], samples[k + 1],
                       static_cast<std::int64_t>(std::llround(1e9 * t)));
  };
  Increments truth;
  for (int k = 0; k < 100; ++k) {
    truth =
        IntegrateFinely([&](double t) { return at(t).gyro; }, [&](double t) { return at(t).accel; },
                        0.005 * k, 0.005 * (k + 1), 20, truth);
  }
  const auto result = Preintegrate(samples, {}, {});
  ASSERT_TRUE(result.ok()) << result.status().message();
  EXPECT_NEAR(result->imu.dt, 0.5, 1e-12);
  const Difference d = Compare(result->imu, truth);
  EXPECT_LT(d.p, 1e-9);
  EXPECT_LT(d.theta, 1e-9);
  EXPECT_LT(d.v, 1e-9);
  EXPECT_GT(so3::Log(result->imu.dq).norm(), 0.5);  // it did turn
}

TEST(Preintegration, AgreesWithFineIntegrationOfTheMotionItself) {
  const Increments truth = IntegrateFinely(test::GyroAt, test::AccelAt, 0.0, 0.5, 20000);
  // A sensor of 2 kHz reaches 1e-6; then the error falls with the square of the period.
  const auto fine = Preintegrate(Samples(1000, 500'000), {}, {});
  const auto coarse = Preintegrate(Samples(500, 1'000'000), {}, {});
  ASSERT_TRUE(fine.ok() && coarse.ok());
  const Difference d1 = Compare(fine->imu, truth), d2 = Compare(coarse->imu, truth);
  EXPECT_LT(d1.p, 1e-6);
  EXPECT_LT(d1.theta, 1e-6);
  EXPECT_LT(d1.v, 1e-6);
  for (const double ratio : {d2.p / d1.p, d2.theta / d1.theta, d2.v / d1.v})
    EXPECT_NEAR(ratio, 4.0, 0.2);
}

TEST(Preintegration, BiasesAreTakenOff) {
  const ImuBias bias{{0.3, -0.2, 0.1}, {0.02, 0.05, -0.03}};
  const auto samples = Samples(60, 5'000'000);
  const auto plain = Preintegrate(samples, {}, {});
  const auto biased = Preintegrate(test::WithBias(samples, bias), bias, {});
  ASSERT_TRUE(plain.ok() && biased.ok());
  EXPECT_LT((plain->imu.dp - biased->imu.dp).norm(), 1e-13);
  EXPECT_LT((plain->imu.dv - biased->imu.dv).norm(), 1e-13);
  EXPECT_LT((plain->imu.dq.coeffs() - biased->imu.dq.coeffs()).norm(), 1e-13);
  EXPECT_EQ(biased->imu.ba_lin, bias.ba);
  EXPECT_EQ(biased->imu.bg_lin, bias.bg);
}

TEST(Preintegration, BiasJacobiansAgreeWithIntegrationAgain) {
  const auto samples = Samples(100, 5'000'000);
  const ImuBias bias{{0.1, -0.2, 0.3}, {0.01, 0.02, -0.03}};
  const auto middle = Preintegrate(samples, bias, {});
  ASSERT_TRUE(middle.ok());
  const PreintegratedImu& imu = middle->imu;
  const double step = 1e-5;
  for (int k = 0; k < 3; ++k) {
    for (const bool gyro : {false, true}) {
      ImuBias up = bias, down = bias;
      (gyro ? up.bg : up.ba)[k] += step;
      (gyro ? down.bg : down.ba)[k] -= step;
      const PreintegratedImu a = Preintegrate(samples, up, {})->imu;
      const PreintegratedImu b = Preintegrate(samples, down, {})->imu;
      const Vector3 dp = (a.dp - b.dp) / (2 * step), dv = (a.dv - b.dv) / (2 * step);
      const Vector3 dq = (so3::Log(Quaternion(imu.dq.conjugate() * a.dq)) -
                          so3::Log(Quaternion(imu.dq.conjugate() * b.dq))) /
                         (2 * step);
      EXPECT_LT((dp - (gyro ? imu.dp_dbg : imu.dp_dba).col(k)).norm(), 1e-8) << gyro << k;
      EXPECT_LT((dv - (gyro ? imu.dv_dbg : imu.dv_dba).col(k)).norm(), 1e-8) << gyro << k;
      EXPECT_LT((dq - (gyro ? Vector3(imu.dq_dbg.col(k)) : Vector3::Zero())).norm(), 1e-8)
          << gyro << k;
    }
  }
}

TEST(Preintegration, SaturationInflatesTheNoiseOfItsSteps) {
  auto samples = Samples(20, 5'000'000);
  const auto clean = Preintegrate(samples, {}, {});
  samples[10].accel_saturated = true;
  const auto accel = Preintegrate(samples, {}, {});
  samples[10].accel_saturated = false;
  samples[10].gyro_saturated = true;
  const auto gyro = Preintegrate(samples, {}, {});
  ASSERT_TRUE(clean.ok() && accel.ok() && gyro.ok());
  // Two steps of twenty at 100 sigma: (18 + 2 * 100^2) / 20 of the variance.
  const double factor = (18.0 + 2e4) / 20.0;
  EXPECT_NEAR(accel->covariance(6, 6) / clean->covariance(6, 6), factor, 0.02 * factor);
  EXPECT_EQ(accel->covariance(3, 3), clean->covariance(3, 3));
  EXPECT_NEAR(gyro->covariance(3, 3) / clean->covariance(3, 3), factor, 0.02 * factor);
  EXPECT_EQ(accel->imu.dp, clean->imu.dp);
}

TEST(Preintegration, RefusesWhatMakesNoSense) {
  const auto samples = Samples(3, 5'000'000);
  EXPECT_EQ(Preintegrate({}, {}, {}).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(Preintegrate(std::span(samples).first(1), {}, {}).status().code(),
            StatusCode::kInvalidArgument);
  auto twice = samples;
  twice[2].stamp_ns = twice[1].stamp_ns;
  EXPECT_EQ(Preintegrate(twice, {}, {}).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(Preintegrate(samples, {}, {.gyro_noise_density = 0.0}).status().code(),
            StatusCode::kNotPositive);
  EXPECT_EQ(Preintegrate(samples, {}, {.accel_random_walk = -1.0}).status().code(),
            StatusCode::kNotPositive);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Preintegrate(samples, {Vector3(0, nan, 0), Vector3::Zero()}, {}).status().code(),
            StatusCode::kNotFinite);
  auto spoiled = samples;
  spoiled[1].gyro[2] = nan;
  EXPECT_EQ(Preintegrate(spoiled, {}, {}).status().code(), StatusCode::kNotFinite);
  // Finite samples whose integral is not.
  auto huge = samples;
  huge[1].accel[0] = 1e308;
  huge[2].accel[0] = 1e308;
  EXPECT_EQ(Preintegrate(huge, {}, {}).status().code(), StatusCode::kNotFinite);
  huge = samples;
  huge[1].gyro[0] = 1e200;
  EXPECT_EQ(Preintegrate(huge, {}, {}).status().code(), StatusCode::kNotFinite);
}

TEST(Preintegration, ARefusedSampleChangesNothing) {
  const auto samples = Samples(3, 5'000'000);
  ImuPreintegrator integrator;
  EXPECT_FALSE(integrator.Add(samples[0]).ok());
  ASSERT_TRUE(integrator.Start(samples[0], {}, {}).ok());
  EXPECT_EQ(integrator.Get().imu.dt, 0.0);
  ASSERT_TRUE(integrator.Add(samples[1]).ok());
  const auto before = integrator.Get();
  ImuSample bad = samples[2];
  bad.accel[1] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(integrator.Add(bad).ok());
  EXPECT_FALSE(integrator.Add(samples[0]).ok());
  EXPECT_EQ(integrator.Get().imu.dp, before.imu.dp);
  EXPECT_EQ(integrator.Get().covariance, before.covariance);
  EXPECT_TRUE(integrator.Add(samples[2]).ok());
  EXPECT_EQ(integrator.Get().imu.dp, Preintegrate(std::span(samples).first(3), {}, {})->imu.dp);
}

}  // namespace
}  // namespace glissade
