// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/vi_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "glissade/problem/problem.h"
#include "glissade/sim/evaluation.h"

namespace glissade::sim {
namespace {

ViWorldOptions Options(TrajectoryKind trajectory, PointLayout points) {
  ViWorldOptions options;
  options.trajectory = trajectory;
  options.points = points;
  return options;
}

class Worlds : public ::testing::TestWithParam<std::tuple<TrajectoryKind, PointLayout>> {
 protected:
  ViWorldOptions options_ = Options(std::get<0>(GetParam()), std::get<1>(GetParam()));
};

TEST_P(Worlds, ExactMeasurementsHaveNoResidual) {
  options_.pixel_noise = 0.0;
  options_.imu_rate_hz = 2000.0;  // so that samples are nearly the motion itself
  const auto world = MakeViWorld(options_);
  ASSERT_TRUE(world.ok()) << world.status().message();
  ViProblem exact = world->exact;
  for (std::size_t k = 0; k + 1 < exact.stamps_ns.size(); ++k) {
    std::vector<ImuSample> samples;
    for (const ImuSample& s : world->imu_samples) {
      if (s.stamp_ns >= exact.stamps_ns[k] && s.stamp_ns <= exact.stamps_ns[k + 1])
        samples.push_back(s);
    }
    // Keyframes need not be on samples: complete the ends from the trajectory.
    for (const bool end : {false, true}) {
      const std::int64_t stamp = exact.stamps_ns[k + (end ? 1 : 0)];
      if (!samples.empty() && (end ? samples.back() : samples.front()).stamp_ns == stamp) continue;
      const double t = 1e-9 * static_cast<double>(stamp);
      const Trajectory& path = world->trajectory;
      const Vector3 f = path.AccelerationAt(t) - options_.gravity;
      const ImuSample s{.stamp_ns = stamp,
                        .gyro = path.AngularRateAt(t),
                        .accel = path.RotationAt(t).transpose() * f};
      samples.insert(end ? samples.end() : samples.begin(), s);
    }
    exact.imu.push_back(*MakeImuFactor(*Preintegrate(samples, {}, options_.imu_noise)));
  }
  Graph graph;
  const auto handles = AddToGraph(exact, {}, &graph);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  double pixels = 0.0, imu = 0.0;
  for (const auto& edge : handles->observations)
    pixels += graph.Chi2(edge).value();
  for (const auto& edge : handles->imu)
    imu += graph.Chi2(edge).value();
  EXPECT_LT(pixels, 1e-20);
  EXPECT_LT(imu, 1e-2);
  EXPECT_GE(exact.observations.size(), 3u * 50u);
  for (const auto& edge : handles->observations)
    EXPECT_GE(graph.DepthOf(edge).value(), 0.5);
}

TEST_P(Worlds, NoiseIsThatOfTheModel) {
  // At the truth, Chi2 of pixels has 2 per observation, of IMU terms 15 each (the walk of the
  // biases is in the truth).
  const auto world = MakeViWorld(options_);
  ASSERT_TRUE(world.ok());
  double pixels = 0.0, imu = 0.0;
  int num_pixels = 0, num_imu = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    auto problem = Measure(*world, seed);
    ASSERT_TRUE(problem.ok()) << problem.status().message();
    problem->start = problem->truth;
    Graph graph;
    const auto handles = AddToGraph(*problem, {}, &graph);
    ASSERT_TRUE(handles.ok());
    for (const auto& edge : handles->observations)
      pixels += graph.Chi2(edge).value();
    for (const auto& edge : handles->imu)
      imu += graph.Chi2(edge).value();
    num_pixels += 2 * static_cast<int>(handles->observations.size());
    num_imu += 15 * static_cast<int>(handles->imu.size());
  }
  EXPECT_NEAR(pixels / num_pixels, 1.0, 0.02);
  EXPECT_NEAR(imu / num_imu, 1.0, 0.06);
}

TEST_P(Worlds, TheStartIsAsFarOffAsSaid) {
  const auto world = MakeViWorld(options_);
  const auto problem = Measure(*world, 3);
  ASSERT_TRUE(problem.ok());
  for (std::size_t k = 0; k < problem->truth.poses.size(); ++k) {
    double d[6];
    problem->start.poses[k].Minus(problem->truth.poses[k], d);
    EXPECT_NEAR(Vector3(d[0], d[1], d[2]).norm(), 0.05, 1e-12);
    EXPECT_NEAR(Vector3(d[3], d[4], d[5]).norm(), 6.0 * std::numbers::pi / 180.0, 1e-9);
    double s[9];
    problem->start.speed_biases[k].Minus(problem->truth.speed_biases[k], s);
    EXPECT_LE(std::abs(s[0]), 0.05);
    EXPECT_NE(s[0], 0.0);
    for (int i = 3; i < 9; ++i)
      EXPECT_EQ(s[i], 0.0);
  }
}

TEST_P(Worlds, SolvingBringsItBack) {
  const auto world = MakeViWorld(options_);
  const auto problem = Measure(*world, 5);
  ASSERT_TRUE(problem.ok());
  Problem graph;
  const auto handles = AddToGraph(*problem, {}, &graph);
  ASSERT_TRUE(handles.ok());
  const auto before = AlignedErrors(problem->start, problem->truth);
  const auto& summary = graph.Solve({.gauge = Gauge::Fixed{handles->poses[0]}});
  EXPECT_TRUE(summary.converged()) << summary.BriefReport();
  const auto after = AlignedErrors(StatesOf(graph, *handles), problem->truth);
  ASSERT_TRUE(before.ok() && after.ok());
  EXPECT_LT(after->rotation_deg, 0.2 * before->rotation_deg);
  EXPECT_LT(after->position_m, 0.2);
  // No more than noise: the cost is under that of the truth, which has 1/2 per residual.
  ViProblem truth = *problem;
  truth.start = truth.truth;
  Graph at_truth;
  ASSERT_TRUE(AddToGraph(truth, {}, &at_truth).ok());
  EXPECT_LT(summary.final_cost, at_truth.Cost().value());
  EXPECT_GT(summary.final_cost, 0.5 * at_truth.Cost().value());
}

INSTANTIATE_TEST_SUITE_P(
    All, Worlds,
    ::testing::Combine(::testing::Values(TrajectoryKind::kSine, TrajectoryKind::kArc,
                                         TrajectoryKind::kRec),
                       ::testing::Values(PointLayout::kPlane, PointLayout::kRandom)),
    [](const auto& info) {
      return std::string(ToString(std::get<0>(info.param))) + "_" +
             std::string(ToString(std::get<1>(info.param)));
    });

TEST(ViWorld, SameSeedSameNumbers) {
  const auto a = MakeViWorld({}), b = MakeViWorld({});
  ViWorldOptions other;
  other.seed = 2;
  const auto c = MakeViWorld(other);
  EXPECT_EQ(a->exact.truth.points[7].p(), b->exact.truth.points[7].p());
  EXPECT_NE(a->exact.truth.points[7].p(), c->exact.truth.points[7].p());
  const auto x = Measure(*a, 1), y = Measure(*b, 1), z = Measure(*a, 2);
  EXPECT_EQ(x->observations[5].u, y->observations[5].u);
  EXPECT_NE(x->observations[5].u, z->observations[5].u);
  EXPECT_EQ(x->imu[3].edge.imu.dp, y->imu[3].edge.imu.dp);
  EXPECT_NE(x->imu[3].edge.imu.dp, z->imu[3].edge.imu.dp);
  EXPECT_NE(x->start.points[0].p(), z->start.points[0].p());
}

TEST(ViWorld, RefusesWhatMakesNoSense) {
  const auto refused = [](auto&& spoil) {
    ViWorldOptions options;
    spoil(options);
    const auto world = MakeViWorld(options);
    EXPECT_FALSE(world.ok());
    EXPECT_FALSE(world.status().message().empty());
  };
  refused([](ViWorldOptions& o) { o.trajectory = static_cast<TrajectoryKind>(9); });
  refused([](ViWorldOptions& o) { o.points = static_cast<PointLayout>(-1); });
  refused([](ViWorldOptions& o) { o.length_m = 0.0; });
  refused([](ViWorldOptions& o) { o.speed_mps = std::nan(""); });
  refused([](ViWorldOptions& o) { o.speed_mps = 1e-9; });
  refused([](ViWorldOptions& o) { o.num_keyframes = 1; });
  refused([](ViWorldOptions& o) { o.num_points = 0; });
  refused([](ViWorldOptions& o) { o.min_observations = 50; });
  refused([](ViWorldOptions& o) { o.camera.width = 0; });
  refused([](ViWorldOptions& o) { o.pixel_noise = -1.0; });
  refused([](ViWorldOptions& o) { o.imu_rate_hz = 1.0; });
  refused([](ViWorldOptions& o) { o.imu_noise.gyro_random_walk = 0.0; });
  refused([](ViWorldOptions& o) { o.max_depth_m = 1.0; });
  refused([](ViWorldOptions& o) { o.gravity[2] = std::numeric_limits<double>::infinity(); });
  EXPECT_FALSE(Measure(ViWorld{}, 1).ok());
}

TEST(ViProblem, RefusesWhatDoesNotMatch) {
  const auto problem = Measure(*MakeViWorld({}), 1);
  const auto refused = [&](auto&& spoil) {
    ViProblem spoiled = *problem;
    spoil(spoiled);
    Graph graph;
    EXPECT_FALSE(AddToGraph(spoiled, {}, &graph).ok());
  };
  refused([](ViProblem& p) { p.imu.pop_back(); });
  refused([](ViProblem& p) { p.start.speed_biases.pop_back(); });
  refused([](ViProblem& p) { p.observations[3].point = 100000; });
  refused([](ViProblem& p) { p.observations[3].keyframe = -1; });
  refused([](ViProblem& p) { p.observations[3].camera = 1; });
  refused([](ViProblem& p) { p.observations[3].u = std::nan(""); });
  refused([](ViProblem& p) { p.cameras[0].sigma_px = 0.0; });
  refused([](ViProblem& p) { p.start.points[0].data[1] = std::nan(""); });
}

/// A rotation by yaw about world z, then a translation.
eval::Alignment Turned(double yaw, const Vector3& t) {
  eval::Alignment motion;
  motion.T_r_e = Pose(so3::ExpQuaternion({0, 0, yaw}), t);
  return motion;
}

TEST(Evaluation, ErrorsDoNotDependOnTheGauge) {
  const auto problem = Measure(*MakeViWorld({}), 1);
  const auto once = AlignedErrors(problem->start, problem->truth);
  const ViStates moved = Moved(problem->start, Turned(2.5, {3.0, -4.0, 5.0}));
  const auto again = AlignedErrors(moved, problem->truth);
  ASSERT_TRUE(once.ok() && again.ok());
  EXPECT_NEAR(once->position_m, again->position_m, 1e-12);
  EXPECT_NEAR(once->rotation_deg, again->rotation_deg, 1e-10);
  EXPECT_NEAR(once->velocity_mps, again->velocity_mps, 1e-12);
  const ViDifference same = AlignedDifference(problem->start, moved, problem->truth);
  EXPECT_LT(same.position_m, 1e-12);
  EXPECT_LT(same.rotation_rad, 1e-12);
  const auto zero = AlignedErrors(Moved(problem->truth, Turned(-1.0, {1, 2, 3})), problem->truth);
  EXPECT_LT(zero->position_m, 1e-12);
  EXPECT_LT(zero->rotation_deg, 1e-6);
  EXPECT_FALSE(AlignedErrors({}, {}).ok());
}

}  // namespace
}  // namespace glissade::sim
