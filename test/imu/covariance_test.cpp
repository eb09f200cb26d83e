// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "common/sanitized.h"
#include "glissade/imu/imu_factor.h"
#include "glissade/imu/preintegration.h"
#include "glissade/sim/random.h"
#include "imu/imu_signal.h"

// The covariance of preintegration against Monte-Carlo: samples with the noise of their densities,
// biases that walk; the errors are the residuals of the edge between true states.

namespace glissade {
namespace {

using Covariance = Eigen::Matrix<double, 15, 15>;

Covariance MonteCarlo(const std::vector<ImuSample>& samples, const ImuNoise& noise, int runs) {
  const PreintegratedImu truth = Preintegrate(samples, {}, noise)->imu;
  // True states of the noiseless motion, from rest at the origin.
  EdgeImu edge;
  edge.imu = truth;
  const VertexPose pose_i;
  const VertexSpeedBias sb_i;
  const ImuPrediction end = Predict(edge, pose_i, sb_i);

  sim::MinstdRand0 engine(12345);
  sim::NormalReal normal;
  const auto draw = [&](double sigma) {
    return Vector3(sigma * normal(engine), sigma * normal(engine), sigma * normal(engine));
  };
  Covariance sum = Covariance::Zero();
  const double h = SecondsBetween(samples[0].stamp_ns, samples[1].stamp_ns);
  for (int run = 0; run < runs; ++run) {
    auto noisy = samples;
    Vector3 ba = Vector3::Zero(), bg = Vector3::Zero();
    for (std::size_t k = 0; k < noisy.size(); ++k) {
      if (k > 0) {
        ba += draw(noise.accel_random_walk * std::sqrt(h));
        bg += draw(noise.gyro_random_walk * std::sqrt(h));
      }
      noisy[k].accel += ba + draw(noise.accel_noise_density / std::sqrt(h));
      noisy[k].gyro += bg + draw(noise.gyro_noise_density / std::sqrt(h));
    }
    edge.imu = Preintegrate(noisy, {}, noise)->imu;
    const VertexSpeedBias sb_j(end.speed_bias.v(), ba, bg);
    Vector<15> r;
    EXPECT_TRUE(edge.Evaluate(pose_i, sb_i, end.pose, sb_j, r, nullptr, nullptr, nullptr, nullptr));
    const Eigen::Matrix<double, 15, 1> e = r;
    sum += e * e.transpose();
  }
  return sum / runs;
}

void ExpectAgreement(const ImuNoise& noise) {
  // Half a second: the half of a sample at either end, which neighbouring intervals share and a
  // continuous density knows nothing of, is 0.5 % of the variance.
  const auto samples = test::Samples(100, 5'000'000);
  const Covariance ours = Preintegrate(samples, {}, noise)->covariance;
  constexpr int kRuns = test::kSanitized ? 400 : 5000;
  const Covariance sampled = MonteCarlo(samples, noise, kRuns);
  const double band = 4.0 * std::sqrt(2.0 / kRuns);  // four sigmas of a variance
  for (int k = 0; k < 15; ++k)
    EXPECT_NEAR(sampled(k, k) / ours(k, k), 1.0, band) << "variance " << k;
  // All of it, in units of its own sigmas: whitened, the sampled covariance is the identity.
  SquareMatrix<15> U;
  ASSERT_TRUE(SqrtInformationOf(SquareMatrix<15>(ours), &U).ok());
  const Covariance whitened = Covariance(U) * sampled * Covariance(U).transpose();
  EXPECT_LT((whitened - Covariance::Identity()).cwiseAbs().maxCoeff(), band);
  for (int i = 0; i < 15; ++i) {
    for (int j = 0; j < i; ++j) {
      const double scale = std::sqrt(ours(i, i) * ours(j, j));
      EXPECT_NEAR(sampled(i, j) / scale, ours(i, j) / scale, band) << i << " " << j;
    }
  }
}

TEST(ImuCovariance, AgreesWithMonteCarlo) {
  ExpectAgreement({});
}

TEST(ImuCovariance, AgreesWithMonteCarloWhereBiasesWalkFast) {
  // The walk inside the interval is a good part of the variance of the increments.
  ExpectAgreement({.gyro_noise_density = 2e-4,
                   .accel_noise_density = 2e-3,
                   .gyro_random_walk = 4e-4,
                   .accel_random_walk = 5e-3});
}

TEST(ImuCovariance, DoesNotDependOnHowFinelyTheSignalIsSampled) {
  const auto coarse = Preintegrate(test::Samples(100, 5'000'000), {}, {});
  const auto fine = Preintegrate(test::Samples(1000, 500'000), {}, {});
  for (int k = 0; k < 15; ++k)
    EXPECT_NEAR(coarse->covariance(k, k) / fine->covariance(k, k), 1.0, 0.005) << k;
}

TEST(ImuCovariance, IsRegularFromTheFirstStepOn) {
  for (int n : {1, 2, 3, 400}) {
    const auto result = Preintegrate(test::Samples(n, 5'000'000), {}, {});
    SquareMatrix<15> U;
    ASSERT_TRUE(SqrtInformationOf(result->covariance, &U).ok()) << n;
    const Covariance P = result->covariance, L = U;
    EXPECT_LT((L * P * L.transpose() - Covariance::Identity()).cwiseAbs().maxCoeff(), 1e-9) << n;
  }
}

}  // namespace
}  // namespace glissade
