// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/stillness.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/base/validate.h"
#include "window/quantiles.h"
#include "window/stillness.h"
#include "window/verdicts.h"

namespace glissade {

namespace {

using internal::Refusal;
using internal::Words;

/// More blocks than this are made longer: the matrices grow with their square.
constexpr int kMaxBlocks = 50;
constexpr int kMinBlocks = 4;

// On the stack.
using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxBlocks, 1>;
using Vectors = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMaxBlocks, 3>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxBlocks, kMaxBlocks>;

/// Integrals of rate and force over blocks, the last block first: time runs backward from the last
/// sample, where the biases are wanted.
struct Blocks {
  Values length;            ///< s
  Vectors angle, velocity;  ///< rows: blocks
};

InitVerdict CheckSamples(std::span<const ImuSample> samples, const ImuNoise& noise,
                         const StillnessOptions& options, Words words) {
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (!internal::AllFinite(samples[k].gyro.data(), 3) ||
        !internal::AllFinite(samples[k].accel.data(), 3)) {
      return Refusal(InitReason::kNotFinite, static_cast<double>(k), 0.0, "index of an IMU sample",
                     "", words);
    }
  }
  for (std::size_t k = 1; k < samples.size(); ++k) {
    if (samples[k].stamp_ns <= samples[k - 1].stamp_ns) {
      return {InitReason::kInvalidInput, 0.0, 0.0, "stamps of IMU samples do not increase"};
    }
  }
  const double duration =
      samples.empty() ? 0.0 : SecondsBetween(samples.front().stamp_ns, samples.back().stamp_ns);
  if (duration < options.min_duration_s) {
    return Refusal(InitReason::kTooFewSamples, duration, options.min_duration_s,
                   "span of the IMU samples", "s", words);
  }
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const std::int64_t step = NanosecondsBetween(samples[k - 1].stamp_ns, samples[k].stamp_ns);
    if (step > noise.max_gap_ns) {
      return Refusal(InitReason::kImuGap, 1e-9 * static_cast<double>(step),
                     1e-9 * static_cast<double>(noise.max_gap_ns), "time without a reading", "s",
                     words);
    }
  }
  const auto saturated = std::count_if(samples.begin(), samples.end(), [](const ImuSample& s) {
    return s.gyro_saturated || s.accel_saturated;
  });
  if (saturated > 0) {
    return Refusal(InitReason::kImuSaturated, static_cast<double>(saturated), 0.0,
                   "number of samples at the end of the range", "", words);
  }
  return {};
}

/// Trapezoids; blocks end at samples.
Blocks Integrate(std::span<const ImuSample> samples, int count) {
  Blocks blocks;
  blocks.length.setZero(count);
  blocks.angle.setZero(count, 3);
  blocks.velocity.setZero(count, 3);
  const auto steps = static_cast<std::ptrdiff_t>(samples.size()) - 1;
  for (std::ptrdiff_t k = 0; k < steps; ++k) {
    const ImuSample& a = samples[static_cast<std::size_t>(k)];
    const ImuSample& b = samples[static_cast<std::size_t>(k) + 1];
    const double h = SecondsBetween(a.stamp_ns, b.stamp_ns);
    const auto block = static_cast<Eigen::Index>(count - 1 - k * count / steps);
    blocks.length[block] += h;
    blocks.angle.row(block) += 0.5 * h * (a.gyro + b.gyro).transpose();
    blocks.velocity.row(block) += 0.5 * h * (a.accel + b.accel).transpose();
  }
  return blocks;
}

/// Of what the sensor adds to the integrals: white noise, and a bias that starts from what is
/// sought and walks.
Square SensorCovariance(const Values& length, double density, double walk) {
  const Eigen::Index n = length.size();
  Square C(n, n);
  double start_k = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double h = length[k];
    // E[W(s) W(t)] = min(s, t), integrated over both blocks.
    C(k, k) = density * density * h + walk * walk * h * h * (start_k + h / 3.0);
    for (Eigen::Index l = k + 1; l < n; ++l)
      C(k, l) = C(l, k) = walk * walk * h * (start_k + 0.5 * h) * length[l];
    start_k += h;
  }
  return C;
}

struct Fit {
  Vector3 mean = Vector3::Zero();
  double variance = 0.0;
  double chi2 = 0.0;
  double log_likelihood = 0.0;
};

/// y_k = mean h_k + e_k, by generalised least squares with cov(e) = C + tremble^2 D D'.
Fit FitConstant(const Values& length, const Vectors& y, const Square& C, double tremble) {
  Square S = C;
  const double t2 = tremble * tremble;
  S.diagonal().array() += 2.0 * t2;
  S.diagonal(1).array() -= t2;
  S.diagonal(-1).array() -= t2;
  const Eigen::LLT<Square> llt(S);
  Fit fit;
  if (llt.info() != Eigen::Success) {
    fit.chi2 = std::numeric_limits<double>::infinity();
    return fit;
  }
  const Values h = llt.matrixL().solve(length);
  const Vectors z = llt.matrixL().solve(y);
  fit.variance = 1.0 / h.squaredNorm();
  fit.mean = fit.variance * z.transpose() * h;
  fit.chi2 = (z - h * fit.mean.transpose()).squaredNorm();
  const double log_det = 2.0 * llt.matrixLLT().diagonal().array().log().sum();
  fit.log_likelihood = -0.5 * fit.chi2 - 1.5 * log_det + 1.5 * std::log(fit.variance);
  return fit;
}

/// Of the log likelihood: what a tremble must explain better than none does (chi2 with one degree
/// of freedom, 95 %), before there is one.
constexpr double kSignificant = 0.5 * 3.84;

/// The likeliest tremble up to `most`, on a grid of factors of 2, and the fit with it; none where
/// the readings do not ask for one.
double LikeliestTremble(const Blocks& blocks, const Vectors& y, const Square& C, double most,
                        Fit* best) {
  double tremble = 0.0;
  *best = FitConstant(blocks.length, y, C, 0.0);
  double likeliest = best->log_likelihood + kSignificant;
  for (int k = 0; k < 8; ++k) {
    const double t = std::ldexp(most, -k);
    const Fit fit = FitConstant(blocks.length, y, C, t);
    if (!(fit.log_likelihood > likeliest)) continue;
    likeliest = fit.log_likelihood;
    *best = fit;
    tremble = t;
  }
  return tremble;
}

}  // namespace

Status StillnessOptions::Validate() const {
  if (Status s = ValidatePositive(tremble_angle, "tremble_angle"); !s.ok()) return s;
  if (Status s = ValidatePositive(tremble_speed, "tremble_speed"); !s.ok()) return s;
  if (Status s = ValidatePositive(block_s, "block_s"); !s.ok()) return s;
  if (Status s = ValidatePositive(min_duration_s, "min_duration_s"); !s.ok()) return s;
  if (!(false_alarm > 0.0 && false_alarm < 0.5)) {
    return {StatusCode::kInvalidArgument, "false_alarm must be between 0 and 0.5"};
  }
  return {};
}

StillnessTest internal::TestStillness(std::span<const ImuSample> samples, const ImuNoise& noise,
                                      const StillnessOptions& options, Words words) {
  StillnessTest test;
  for (const Status& s : {options.Validate(), noise.Validate()}) {
    if (!s.ok()) {
      test.verdict = internal::InvalidInput(s);
      return test;
    }
  }
  test.verdict = CheckSamples(samples, noise, options, words);
  if (!test.verdict.ok()) return test;
  test.duration_s = SecondsBetween(samples.front().stamp_ns, samples.back().stamp_ns);
  const double wanted = std::min(test.duration_s / options.block_s, double{kMaxBlocks});
  const int count = std::max(static_cast<int>(std::lround(wanted)), kMinBlocks);
  if (samples.size() < static_cast<std::size_t>(2 * count + 1)) {
    test.verdict = Refusal(InitReason::kTooFewSamples, static_cast<double>(samples.size()),
                           2.0 * count + 1.0, "number of IMU samples", "", words);
    return test;
  }

  const Blocks blocks = Integrate(samples, count);
  const Square C_gyro =
      SensorCovariance(blocks.length, noise.gyro_noise_density, noise.gyro_random_walk);
  const Square C_accel =
      SensorCovariance(blocks.length, noise.accel_noise_density, noise.accel_random_walk);
  test.gyro_chi2 = FitConstant(blocks.length, blocks.angle, C_gyro, options.tremble_angle).chi2;
  test.accel_chi2 =
      FitConstant(blocks.length, blocks.velocity, C_accel, options.tremble_speed).chi2;
  test.dof = 3 * (count - 1);
  test.max_chi2 = internal::Chi2Quantile(test.dof, options.false_alarm);
  Fit rate, force;
  test.tremble_angle = LikeliestTremble(blocks, blocks.angle, C_gyro, options.tremble_angle, &rate);
  test.tremble_speed =
      LikeliestTremble(blocks, blocks.velocity, C_accel, options.tremble_speed, &force);
  test.rate = rate.mean;
  test.rate_variance = rate.variance;
  test.force = force.mean;
  test.force_variance = force.variance;

  // In this form a NaN does not pass.
  if (!(test.gyro_chi2 <= test.max_chi2)) {
    test.verdict = Refusal(InitReason::kMoving, test.gyro_chi2, test.max_chi2,
                           "chi2 of the angles that a constant rate leaves", "", words);
  } else if (!(test.accel_chi2 <= test.max_chi2)) {
    test.verdict = Refusal(InitReason::kMoving, test.accel_chi2, test.max_chi2,
                           "chi2 of the velocities that a constant force leaves", "", words);
  } else if (!internal::AllFinite(test.rate.data(), 3) ||
             !internal::AllFinite(test.force.data(), 3)) {
    test.verdict = {InitReason::kNotFinite, 0.0, 0.0, "mean of the IMU samples overflows"};
  }
  return test;
}

StillnessTest TestStillness(std::span<const ImuSample> samples, const ImuNoise& noise,
                            const StillnessOptions& options) {
  return internal::TestStillness(samples, noise, options, internal::Words::kYes);
}

}  // namespace glissade
