// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "eval_test_util.h"
#include "glissade/eval/absolute_error.h"
#include "glissade/eval/relative_error.h"

namespace glissade::eval {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

MatchedTrajectories NoisyWalk(std::uint64_t seed, int n) {
  Engine engine(seed);
  MatchedTrajectories m;
  m.reference = RandomTrajectory(engine, n);
  m.estimate = Noisy(engine, m.reference, 0.05, 0.02);
  return m;
}

TEST(Statistics, OfKnownNumbers) {
  EXPECT_EQ(StatisticsOf({}).count, 0u);
  EXPECT_EQ(StatisticsOf({}).rmse, 0.0);
  const std::vector<double> odd = {3, 1, 2};
  EXPECT_EQ(StatisticsOf(odd).median, 2.0);
  EXPECT_EQ(StatisticsOf(odd).mean, 2.0);
  EXPECT_EQ(StatisticsOf(odd).max, 3.0);
  EXPECT_DOUBLE_EQ(StatisticsOf(odd).rmse, std::sqrt(14.0 / 3));
  const std::vector<double> even = {10, 1, 7, 2};
  EXPECT_EQ(StatisticsOf(even).median, 4.5);
  EXPECT_EQ(StatisticsOf(even).count, 4u);
}

TEST(AbsoluteErrors, OfKnownErrors) {
  MatchedTrajectories m = NoisyWalk(1, 5);
  m.estimate = m.reference;
  const auto none = ComputeAbsoluteErrors(m);
  ASSERT_TRUE(none.ok());
  EXPECT_EQ(none->translation_m.max, 0.0);
  EXPECT_LT(none->rotation_deg.max, 1e-12);

  m.estimate[0].T_w_b.p() += Vector3(3, 0, 4);
  m.estimate[2].T_w_b =
      Pose(so3::ExpQuaternion({0, 0, -0.2}), Vector3::Zero()) * m.estimate[2].T_w_b;
  m.estimate[2].T_w_b.p() = m.reference[2].T_w_b.p();
  m.estimate[3].T_w_b =
      Pose(so3::ExpQuaternion({0.1, 0, 0}), Vector3::Zero()) * m.estimate[3].T_w_b;
  m.estimate[3].T_w_b.p() = m.reference[3].T_w_b.p();
  const auto errors = ComputeAbsoluteErrors(m);
  ASSERT_TRUE(errors.ok());
  EXPECT_NEAR(errors->translation_m.rmse, std::sqrt(25.0 / 5), 1e-14);
  EXPECT_NEAR(errors->translation_m.mean, 1.0, 1e-14);
  EXPECT_EQ(errors->translation_m.median, 0.0);
  EXPECT_NEAR(errors->translation_m.max, 5.0, 1e-14);
  EXPECT_NEAR(errors->rotation_deg.rmse, kDegrees * std::sqrt((0.04 + 0.01) / 5), 1e-11);
  EXPECT_NEAR(errors->yaw_deg.max, kDegrees * 0.2, 1e-11);
  ASSERT_EQ(errors->poses.size(), 5u);
  EXPECT_EQ(errors->poses[0].stamp_ns, m.estimate[0].stamp_ns);
  EXPECT_NEAR(errors->poses[0].translation[2], 4.0, 1e-14);
  EXPECT_NEAR(errors->poses[2].yaw_deg, -kDegrees * 0.2, 1e-11);
  EXPECT_NEAR(errors->poses[3].yaw_deg, 0.0, 1e-11);

  AbsoluteErrorOptions options;
  options.vertical = {-2, 0, 0};
  const auto about_x = ComputeAbsoluteErrors(m, options);
  ASSERT_TRUE(about_x.ok());
  EXPECT_NEAR(about_x->poses[2].yaw_deg, 0.0, 1e-11);
  EXPECT_NEAR(about_x->poses[3].yaw_deg, -kDegrees * 0.1, 1e-11);
}

TEST(AbsoluteErrors, Refusals) {
  MatchedTrajectories m = NoisyWalk(2, 5);
  AbsoluteErrorOptions options;
  options.vertical = Vector3::Zero();
  EXPECT_EQ(ComputeAbsoluteErrors(m, options).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(ComputeAbsoluteErrors({}).status().code(), StatusCode::kInvalidArgument);
  m.estimate[1].T_w_b.data[0] = 1e200;
  EXPECT_EQ(ComputeAbsoluteErrors(m).status().code(), StatusCode::kNotFinite);
  m.estimate[1].T_w_b.data[0] = std::nan("");
  EXPECT_EQ(ComputeAbsoluteErrors(m).status().code(), StatusCode::kNotFinite);
  m.estimate.pop_back();
  EXPECT_EQ(ComputeAbsoluteErrors(m).status().code(), StatusCode::kInvalidArgument);
}

/// The error of a pair by 4 x 4 matrices.
PairError NaiveError(const MatchedTrajectories& m, std::size_t i, std::size_t j) {
  const auto matrix = [](const Pose& pose) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = pose.R();
    T.topRightCorner<3, 1>() = pose.p();
    return T;
  };
  const Eigen::Matrix4d Qi = matrix(m.reference[i].T_w_b), Qj = matrix(m.reference[j].T_w_b);
  const Eigen::Matrix4d Pi = matrix(m.estimate[i].T_w_b), Pj = matrix(m.estimate[j].T_w_b);
  const Eigen::Matrix4d E = (Qi.inverse() * Qj).inverse() * (Pi.inverse() * Pj);
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(E.topLeftCorner<3, 3>()));
  return {i, j, E.topRightCorner<3, 1>().norm(), kDegrees * turn.angle()};
}

void ExpectSame(const std::vector<PairError>& found, const std::vector<PairError>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].first, expected[k].first);
    EXPECT_EQ(found[k].last, expected[k].last);
    EXPECT_NEAR(found[k].translation_m, expected[k].translation_m, 1e-10);
    EXPECT_NEAR(found[k].rotation_deg, expected[k].rotation_deg, 1e-10);
  }
}

TEST(RelativeErrors, OverTimeAgreesWithASearchOverAllPairs) {
  Engine engine(3);
  for (const int every : {1, 7}) {
    MatchedTrajectories m = NoisyWalk(3, 200);
    for (std::size_t k = 0; k < m.estimate.size(); ++k) {  // stamps that jitter, and gaps
      m.estimate[k].stamp_ns += static_cast<std::int64_t>(engine.Uniform(-4e7, 4e7));
      if (k >= 100) m.estimate[k].stamp_ns += 730'000'000;
      m.reference[k].stamp_ns = m.estimate[k].stamp_ns;
    }
    TimeRpeOptions options;
    options.every = every;
    options.tolerance_ns = 30'000'000;
    std::vector<PairError> expected;
    std::vector<double> translations;
    for (std::size_t i = 0; i < 200; i += static_cast<std::size_t>(every)) {
      std::size_t best = i;
      std::int64_t off = 30'000'001;
      for (std::size_t j = i + 1; j < 200; ++j) {
        const std::int64_t d =
            std::abs(m.estimate[j].stamp_ns - m.estimate[i].stamp_ns - 1'000'000'000);
        if (d < off) best = j, off = d;
      }
      const bool ends = m.estimate[199].stamp_ns - m.estimate[i].stamp_ns < 1'000'000'000;
      if (best != i && !ends) expected.push_back(NaiveError(m, i, best));
    }
    for (const PairError& e : expected)
      translations.push_back(e.translation_m);
    ASSERT_GT(expected.size(), 10u);
    ASSERT_LT(expected.size(), 190u / static_cast<std::size_t>(every));
    const auto rpe = RpeOverTime(m, options);
    ASSERT_TRUE(rpe.ok()) << rpe.status().message();
    ExpectSame(rpe->pairs, expected);
    EXPECT_NEAR(rpe->translation_m.rmse, StatisticsOf(translations).rmse, 1e-12);
  }
}

TEST(RelativeErrors, OverDistanceAgreesWithANaiveSum) {
  const MatchedTrajectories m = NoisyWalk(4, 300);
  DistanceRpeOptions options;
  options.lengths_m = {0.5, 10.0, 42.0, 1000.0};
  options.every = 3;
  const auto rpe = RpeOverDistance(m, options);
  ASSERT_TRUE(rpe.ok()) << rpe.status().message();
  ASSERT_EQ(rpe->by_length.size(), 4u);
  double sum = 0.0, sum_rotation = 0.0;
  std::size_t count = 0;
  for (std::size_t l = 0; l < 4; ++l) {
    const double length = options.lengths_m[l];
    std::vector<PairError> expected;
    double mean = 0.0;
    for (std::size_t i = 0; i < 300; i += 3) {
      double way = 0.0;
      for (std::size_t j = i + 1; j < 300; ++j) {
        way += (m.reference[j].T_w_b.p() - m.reference[j - 1].T_w_b.p()).norm();
        if (way < length) continue;
        expected.push_back(NaiveError(m, i, j));
        mean += 100.0 * expected.back().translation_m / length;
        sum += 100.0 * expected.back().translation_m / length;
        sum_rotation += expected.back().rotation_deg / length;
        ++count;
        break;
      }
    }
    EXPECT_EQ(rpe->by_length[l].length_m, length);
    ExpectSame(rpe->by_length[l].pairs, expected);
    if (!expected.empty()) mean /= static_cast<double>(expected.size());
    EXPECT_NEAR(rpe->by_length[l].translation_percent.mean, mean, 1e-9);
    EXPECT_EQ(rpe->by_length[l].translation_percent.count, expected.size());
  }
  EXPECT_EQ(rpe->by_length[3].pairs.size(), 0u);
  EXPECT_NEAR(rpe->translation_percent.mean, sum / static_cast<double>(count), 1e-9);
  EXPECT_NEAR(rpe->rotation_deg_per_m.mean, sum_rotation / static_cast<double>(count), 1e-9);
  EXPECT_EQ(rpe->translation_percent.count, count);
}

TEST(RelativeErrors, OfADriftThatIsKnown) {
  // Straight ahead at 1 m a step; the estimate is 2 % too long and turns 0.01 deg a metre.
  MatchedTrajectories m;
  for (int k = 0; k < 301; ++k) {
    const double x = k;
    m.reference.push_back({k * 100'000'000LL, Pose(Quaternion::Identity(), {x, 0, 0})});
    m.estimate.push_back({k * 100'000'000LL,
                          Pose(so3::ExpQuaternion({0.01 / kDegrees * x, 0, 0}), {1.02 * x, 0, 0})});
  }
  DistanceRpeOptions options;
  options.lengths_m = {50, 100, 200, 400};
  const auto distance = RpeOverDistance(m, options);
  ASSERT_TRUE(distance.ok());
  for (int l = 0; l < 3; ++l) {
    EXPECT_NEAR(distance->by_length[l].translation_percent.mean, 2.0, 1e-9);
    EXPECT_NEAR(distance->by_length[l].rotation_deg_per_m.max, 0.01, 1e-9);
    EXPECT_EQ(distance->by_length[l].pairs.size(), 301 - options.lengths_m[l]);
  }
  const auto time = RpeOverTime(m);
  ASSERT_TRUE(time.ok());
  EXPECT_EQ(time->pairs.size(), 291u);
  EXPECT_NEAR(time->translation_m.max, 0.2, 1e-12);
  EXPECT_NEAR(time->rotation_deg.median, 0.1, 1e-12);
}

TEST(RelativeErrors, DoNotChangeWithARigidMotion) {
  MatchedTrajectories m = NoisyWalk(6, 100);
  DistanceRpeOptions options;
  options.lengths_m = {5};
  const auto before = RpeOverDistance(m, options);
  Engine engine(7);
  const Pose g = RandomPose(engine, 10, 2);
  for (StampedPose& x : m.estimate)
    x.T_w_b = g * x.T_w_b;
  const auto after = RpeOverDistance(m, options);
  ASSERT_TRUE(before.ok() && after.ok());
  EXPECT_NEAR(before->translation_percent.rmse, after->translation_percent.rmse, 1e-10);
  EXPECT_NEAR(before->rotation_deg_per_m.rmse, after->rotation_deg_per_m.rmse, 1e-10);
}

TEST(RelativeErrors, Refusals) {
  const MatchedTrajectories m = NoisyWalk(8, 20);  // 1.9 s, about 10 m
  TimeRpeOptions time;
  time.interval_ns = 5'000'000'000;
  EXPECT_EQ(RpeOverTime(m, time).status().message(),
            "relative errors: no two poses are 5 s apart, within 0.5 s");
  EXPECT_EQ(RpeOverTime({}).status().code(), StatusCode::kInvalidArgument);
  time.interval_ns = 0;
  EXPECT_EQ(RpeOverTime(m, time).status().code(), StatusCode::kInvalidArgument);
  time = {};
  time.every = 0;
  EXPECT_EQ(RpeOverTime(m, time).status().code(), StatusCode::kInvalidArgument);

  EXPECT_EQ(RpeOverDistance(m).status().code(), StatusCode::kInvalidArgument);
  EXPECT_NE(RpeOverDistance(m).status().message().find("segment of 100 m"), std::string::npos);
  EXPECT_EQ(RpeOverDistance({}).status().code(), StatusCode::kInvalidArgument);
  for (const std::vector<double>& lengths :
       {std::vector<double>{}, {0.0}, {-1.0}, {2.0, 1.0}, {1.0, 1.0}, {std::nan("")}}) {
    DistanceRpeOptions options;
    options.lengths_m = lengths;
    EXPECT_EQ(RpeOverDistance(m, options).status().code(), StatusCode::kInvalidArgument);
  }
  MatchedTrajectories huge = m;
  huge.estimate[5].T_w_b.data[1] = 1e200;
  EXPECT_EQ(RpeOverTime(huge).status().code(), StatusCode::kNotFinite);
  huge.reference[5].T_w_b.data[1] = 1e200;
  DistanceRpeOptions options;
  options.lengths_m = {1};
  EXPECT_EQ(RpeOverDistance(huge, options).status().code(), StatusCode::kNotFinite);
}

}  // namespace
}  // namespace glissade::eval
