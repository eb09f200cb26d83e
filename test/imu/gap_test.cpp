// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Where the IMU is silent, its factor must not claim to know: normalized errors against simulated
// motion, with the gap in the middle and at either end of the interval.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "common/random_states.h"
#include "common/sanitized.h"
#include "glissade/imu/buffer.h"
#include "glissade/imu/imu_factor.h"
#include "glissade/sim/noise_source.h"
#include "imu/imu_signal.h"

namespace glissade {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPeriod = 5 * kMs;

/// Readings lost between the two stamps, which still have theirs; the interval of the factor.
struct Case {
  const char* name;
  std::int64_t gap_begin_ms, gap_end_ms, begin_ms, end_ms;
};

constexpr Case kCases[] = {
    {"50 ms and a sample", 200, 255, 0, 400},
    {"0.1 s", 200, 300, 0, 500},
    {"0.5 s", 200, 700, 0, 900},
    {"the interval is the gap", 200, 700, 200, 700},
    {"begins in the gap", 200, 700, 500, 900},
    {"ends in the gap", 200, 700, 0, 450},
    {"inside the gap", 200, 700, 300, 600},
};

/// A motion of one second by the millisecond, its readings, and the two with noise.
class Motion {
 public:
  Motion(const Case& c, std::uint64_t seed) : case_(c), random_(seed), noise_(seed, 0) {
    for (std::int64_t t = 0; t <= 1000 * kMs; t += kMs)
      truth_.push_back({.stamp_ns = t});
  }

  /// Smooth: three sines in each axis, 0.3 to 1.5 Hz, as a lively flight has them.
  void Smooth() {
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < 3; ++k) {
        const double a = random_.Uniform(0.5, 2.0), w = random_.Uniform(0.3, 1.0);
        const double f = random_.Uniform(2.0, 9.0), fw = random_.Uniform(2.0, 9.0);
        const double phase = random_.Uniform(0.0, 6.3), phase_w = random_.Uniform(0.0, 6.3);
        for (ImuSample& s : truth_) {
          const double t = 1e-9 * static_cast<double>(s.stamp_ns);
          s.accel[axis] += a * std::sin(f * t + phase);
          s.gyro[axis] += w * std::sin(fw * t + phase_w);
        }
      }
    }
    for (ImuSample& s : truth_)
      s.accel[2] += 9.81;
  }

  /// Exactly what a gap is taken for: the readings as in Smooth(), linear between them, and in the
  /// gap a random walk that is 0 at both ends.
  void AsModelled(const ImuNoise& noise) {
    Smooth();
    for (ImuSample& s : truth_) {
      const bool lost = Lost(s.stamp_ns);
      const std::int64_t a = lost ? case_.gap_begin_ms * kMs : s.stamp_ns / kPeriod * kPeriod;
      const std::int64_t b = lost ? case_.gap_end_ms * kMs : std::min(a + kPeriod, 1000 * kMs);
      if (a < b && s.stamp_ns != a) s = Interpolate(At(a), At(b), s.stamp_ns);
      s.interpolated_over_ns = 0;
    }
    const std::size_t begin = I(case_.gap_begin_ms), end = I(case_.gap_end_ms);
    std::vector<Vector3> accel(end - begin + 1, Vector3::Zero()), gyro = accel;
    for (std::size_t k = 1; k < accel.size(); ++k) {
      accel[k] = accel[k - 1] + noise_.Normal3(noise.gap_accel_walk * std::sqrt(1e-3));
      gyro[k] = gyro[k - 1] + noise_.Normal3(noise.gap_gyro_walk * std::sqrt(1e-3));
    }
    for (std::size_t k = 0; k < accel.size(); ++k) {
      const double part = static_cast<double>(k) / static_cast<double>(accel.size() - 1);
      truth_[begin + k].accel += accel[k] - part * accel.back();
      truth_[begin + k].gyro += gyro[k] - part * gyro.back();
    }
  }

  /// Squared error of the factor's increments [p, theta, v] in units of its covariance: 9 on
  /// average, if it is honest.
  double Nees(const ImuNoise& noise, ImuGapReport* report = nullptr) {
    ImuBuffer buffer;
    const double root_rate = std::sqrt(1e9 / static_cast<double>(kPeriod));
    for (const ImuSample& s : truth_) {
      if (s.stamp_ns % kPeriod != 0 || Lost(s.stamp_ns)) continue;
      ImuSample reading = s;
      reading.accel += noise_.Normal3(noise.accel_noise_density * root_rate);
      reading.gyro += noise_.Normal3(noise.gyro_noise_density * root_rate);
      EXPECT_TRUE(buffer.Add(reading).ok());
    }
    ImuInterval interval;
    EXPECT_TRUE(buffer.Between(case_.begin_ms * kMs, case_.end_ms * kMs, &interval).ok());
    const auto measured = Preintegrate(interval.samples, {}, noise);
    EXPECT_TRUE(measured.ok()) << measured.status().message();
    if (report != nullptr) *report = measured->gaps;

    const auto exact = Preintegrate(
        std::span(truth_).subspan(I(case_.begin_ms), I(case_.end_ms - case_.begin_ms) + 1), {}, {});
    EdgeImu edge;
    edge.imu = exact->imu;
    const ImuPrediction end = Predict(edge, {}, {});
    edge.imu = measured->imu;
    Vector<15> r;
    EXPECT_TRUE(
        edge.Evaluate({}, {}, end.pose, end.speed_bias, r, nullptr, nullptr, nullptr, nullptr));
    const Eigen::Matrix<double, 9, 1> e = r.head<9>();
    const Eigen::Matrix<double, 9, 9> P = measured->covariance.topLeftCorner<9, 9>();
    return e.dot(P.ldlt().solve(e));
  }

 private:
  static std::size_t I(std::int64_t ms) { return static_cast<std::size_t>(ms); }
  const ImuSample& At(std::int64_t stamp_ns) { return truth_[I(stamp_ns / kMs)]; }
  bool Lost(std::int64_t stamp_ns) const {
    return stamp_ns > case_.gap_begin_ms * kMs && stamp_ns < case_.gap_end_ms * kMs;
  }

  Case case_;
  test::Random random_;
  sim::NoiseSource noise_;
  std::vector<ImuSample> truth_;
};

constexpr int kRuns = test::kSanitized ? 40 : 400;
/// How many of them may be outside of what 1 in 1000 is: 4 % (motions are not what they are
/// modelled as). Of few runs, chance makes it more.
constexpr int kOutside = test::kSanitized ? 5 : 16;

/// Lively, but not as lively as what the defaults allow for.
TEST(ImuGap, IsNoOverconfidentFactor) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.name);
    // The same with next to nothing added, to see that there is something to allow for.
    ImuNoise claims;
    claims.gap_accel_walk = claims.gap_gyro_walk = 1e-6;
    double sum = 0.0, claimed = 0.0;
    int outside = 0;
    for (int run = 0; run < kRuns; ++run) {
      Motion motion(c, static_cast<std::uint64_t>(run));
      motion.Smooth();
      const double nees = motion.Nees({});
      sum += nees;
      outside += nees > 27.88 ? 1 : 0;  // chi2 of 9 degrees of freedom: 0.1 %
      claimed += motion.Nees(claims);
    }
    EXPECT_LT(sum / kRuns, 10.0);
    EXPECT_LE(outside, kOutside);
    if (c.end_ms - c.begin_ms >= 300) {
      EXPECT_GT(claimed / kRuns, 20.0);
    }
  }
}

/// The added covariance is that of the walk it stands for: neither less nor, where the interval has
/// all of the gap, more.
TEST(ImuGap, CovarianceIsThatOfTheWalk) {
  // Small enough for errors of rotation to be linear, as a covariance takes them.
  ImuNoise noise;
  noise.gap_gyro_walk = 0.3;
  noise.gap_accel_walk = 2.0;
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.name);
    double sum = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      Motion motion(c, static_cast<std::uint64_t>(run));
      motion.AsModelled(noise);
      sum += motion.Nees(noise);
    }
    const bool whole = c.begin_ms <= c.gap_begin_ms && c.gap_end_ms <= c.end_ms;
    // The mean of 400 draws of chi2(9) is 9 +- 0.2.
    EXPECT_LT(sum / kRuns, 10.5);
    EXPECT_GT(sum / kRuns, whole ? 8.0 : 1.0);
  }
}

TEST(ImuGap, IsReported) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.name);
    Motion motion(c, 1);
    motion.Smooth();
    ImuGapReport report;
    (void)motion.Nees({}, &report);
    EXPECT_EQ(report.count, 1);
    EXPECT_EQ(report.longest_ns, (c.gap_end_ms - c.gap_begin_ms) * kMs);
    const std::int64_t bridged =
        std::min(c.gap_end_ms, c.end_ms) - std::max(c.gap_begin_ms, c.begin_ms);
    EXPECT_NEAR(report.bridged_s, 1e-3 * static_cast<double>(bridged), 1e-12);
  }
  auto samples = test::Samples(60, kPeriod);
  samples.erase(samples.begin() + 20, samples.begin() + 40);
  const auto preintegration = Preintegrate(samples, {}, {});
  ASSERT_TRUE(preintegration.ok());
  EXPECT_EQ(MakeImuFactor(*preintegration)->gaps.longest_ns, 105 * kMs);
}

TEST(ImuGap, RefusedOnRequestByName) {
  auto samples = test::Samples(60, kPeriod);
  samples.erase(samples.begin() + 20, samples.begin() + 40);
  ImuNoise noise;
  noise.gaps = ImuGaps::kRefuse;
  const Status status = Preintegrate(samples, {}, noise).status();
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(status.message().find("no IMU reading for 105000000 ns"), std::string::npos)
      << status.message();
  // What came before it stays, and so does the way on by other means.
  ImuPreintegrator integrator;
  ASSERT_TRUE(integrator.Start(samples[0], {}, noise).ok());
  for (std::size_t k = 1; k < 20; ++k)
    ASSERT_TRUE(integrator.Add(samples[k]).ok());
  const PreintegratedImu before = integrator.Get().imu;
  EXPECT_FALSE(integrator.Add(samples[20]).ok());
  EXPECT_EQ(integrator.Get().imu.dp, before.dp);
  EXPECT_EQ(integrator.Get().gaps.count, 0);
  // An end that was interpolated in a gap is refused, too, however short the step.
  ImuBuffer buffer;
  for (const ImuSample& s : samples)
    ASSERT_TRUE(buffer.Add(s).ok());
  ImuInterval interval;
  ASSERT_TRUE(buffer.Between(0, 100 * kMs, &interval).ok());
  EXPECT_FALSE(Preintegrate(interval.samples, {}, noise).ok());
  ASSERT_TRUE(buffer.Between(0, 95 * kMs, &interval).ok());
  EXPECT_TRUE(Preintegrate(interval.samples, {}, noise).ok());
}

TEST(ImuGap, WithoutOneNothingChangesToTheBit) {
  // Jitter of up to 2 ms, a few samples lost, ends interpolated: none of it is a gap.
  test::Random random(5);
  ImuBuffer buffer;
  for (int k = 0; k < 100; ++k) {
    if (k % 10 == 3 || k % 10 == 4) continue;
    const auto jitter = static_cast<std::int64_t>(random.Uniform(-2e6, 2e6));
    ASSERT_TRUE(buffer.Add(test::SampleAt(k * kPeriod + jitter)).ok());
  }
  ImuInterval interval;
  ASSERT_TRUE(buffer.Between(17 * kMs, 433 * kMs, &interval).ok());
  ImuNoise refuse;
  refuse.gaps = ImuGaps::kRefuse;
  refuse.gap_accel_walk = refuse.gap_gyro_walk = 1e6;
  ImuNoise never;
  never.max_gap_ns = std::int64_t{1} << 62;
  const auto a = Preintegrate(interval.samples, {}, {});
  const auto b = Preintegrate(interval.samples, {}, refuse);
  const auto c = Preintegrate(interval.samples, {}, never);
  ASSERT_TRUE(a.ok() && b.ok() && c.ok());
  EXPECT_EQ(a->gaps.count, 0);
  EXPECT_EQ(a->covariance, b->covariance);
  EXPECT_EQ(a->covariance, c->covariance);
  EXPECT_EQ(a->imu.dp, c->imu.dp);
}

TEST(ImuGap, OptionsThatMakeNoSense) {
  const auto samples = test::Samples(3, kPeriod);
  const auto refused = [&](const ImuNoise& noise) {
    return !Preintegrate(samples, {}, noise).ok();
  };
  EXPECT_TRUE(refused({.max_gap_ns = 0}));
  EXPECT_TRUE(refused({.gap_gyro_walk = 0.0}));
  EXPECT_TRUE(refused({.gap_accel_walk = std::nan("")}));
  EXPECT_TRUE(refused({.gaps = static_cast<ImuGaps>(7)}));
}

}  // namespace
}  // namespace glissade
