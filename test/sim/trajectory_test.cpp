// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/trajectory.h"

#include <gtest/gtest.h>

#include <string>

#include "glissade/sim/noise_source.h"

namespace glissade::sim {
namespace {

TEST(BSpline, ReproducesPolynomialsUpToItsSmoothness) {
  // Control points on a line give the line.
  std::vector<Vector3> control;
  for (int k = 0; k < 12; ++k)
    control.push_back(Vector3(1, 2, 3) + (k - 2) * 0.5 * Vector3(0.1, -0.2, 0.3));
  const BSpline line(control, 0.5);
  EXPECT_DOUBLE_EQ(line.Duration(), 3.5);
  for (double t = 0.0; t <= 3.5; t += 0.1) {
    EXPECT_LT((line.Evaluate(t) - Vector3(1, 2, 3) - t * Vector3(0.1, -0.2, 0.3)).norm(), 1e-14);
    EXPECT_LT((line.Evaluate(t, 1) - Vector3(0.1, -0.2, 0.3)).norm(), 1e-14);
    EXPECT_LT(line.Evaluate(t, 2).norm(), 1e-13);
  }
}

TEST(BSpline, DerivativesAndContinuity) {
  NoiseSource random(1);
  std::vector<Vector3> control;
  for (int k = 0; k < 15; ++k)
    control.push_back(random.Normal3(1.0));
  const BSpline spline(control, 0.25);
  for (int order = 0; order < 4; ++order) {
    for (double t = 0.01; t < 2.48; t += 0.037) {
      const double h = 1e-6;
      const Vector3 numeric =
          (spline.Evaluate(t + h, order) - spline.Evaluate(t - h, order)) / (2 * h);
      const Vector3 d = spline.Evaluate(t, order + 1);
      EXPECT_LT((numeric - d).norm(), 1e-5 * std::max(1.0, d.norm())) << order << " " << t;
    }
    for (int knot = 1; knot < 10; ++knot) {
      const double t = 0.25 * knot;
      EXPECT_LT((spline.Evaluate(t - 1e-12, order) - spline.Evaluate(t + 1e-12, order)).norm(),
                1e-6);
    }
  }
  EXPECT_EQ(spline.Evaluate(-1.0), spline.Evaluate(0.0));
  EXPECT_EQ(spline.Evaluate(9.0), spline.Evaluate(spline.Duration()));
  EXPECT_EQ(BSpline({}, 1.0).Evaluate(0.5), Vector3(0, 0, 0));
}

class Flights : public ::testing::TestWithParam<TrajectoryKind> {};

TEST_P(Flights, AreAboutFiveMetresAtTwoMetresPerSecond) {
  const Trajectory path(GetParam(), 5.0, 2.0);
  EXPECT_NEAR(path.Duration(), 2.5, 1e-12);
  double length = 0.0, fastest = 0.0, hardest = 0.0;
  constexpr int kSteps = 5000;
  for (int k = 0; k < kSteps; ++k) {
    const double t = path.Duration() * (k + 0.5) / kSteps;
    length += path.VelocityAt(t).norm() * path.Duration() / kSteps;
    fastest = std::max(fastest, path.VelocityAt(t).norm());
    hardest = std::max(hardest, path.AccelerationAt(t).norm());
  }
  EXPECT_NEAR(length, 5.0, 0.5);
  EXPECT_LT(fastest, 3.5);
  EXPECT_GT(hardest, 1.0);
  EXPECT_LT(hardest, 20.0);
}

TEST_P(Flights, RatesAreTheDerivativesOfThePose) {
  const Trajectory path(GetParam(), 5.0, 2.0);
  for (double t = 0.01; t < 2.49; t += 0.03) {
    const double h = 1e-5;
    const Pose a = path.PoseAt(t - h), b = path.PoseAt(t + h);
    EXPECT_LT(((b.p() - a.p()) / (2 * h) - path.VelocityAt(t)).norm(), 1e-7);
    EXPECT_LT(((path.VelocityAt(t + h) - path.VelocityAt(t - h)) / (2 * h) - path.AccelerationAt(t))
                  .norm(),
              1e-5);
    const Vector3 w = so3::Log(Quaternion(a.q().conjugate() * b.q())) / (2 * h);
    EXPECT_LT((w - path.AngularRateAt(t)).norm(), 1e-7);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Flights,
                         ::testing::Values(TrajectoryKind::kSine, TrajectoryKind::kArc,
                                           TrajectoryKind::kRec),
                         [](const auto& info) { return std::string(ToString(info.param)); });

TEST(NoiseSource, Moments) {
  NoiseSource random(3);
  double sum = 0.0, squares = 0.0, fourth = 0.0, cross = 0.0;
  NoiseSource neighbour(4);
  constexpr int kDraws = 200000;
  for (int k = 0; k < kDraws; ++k) {
    const double x = random.Normal(2.0) / 2.0;
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    cross += x * neighbour.Normal(1.0);
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.01);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.01);
  EXPECT_NEAR(fourth / kDraws, 3.0, 0.1);
  EXPECT_NEAR(cross / kDraws, 0.0, 0.01);
}

TEST(NoiseSource, SeedsAndStreamsDiffer) {
  // First numbers of neighbouring seeds are as good as any: their mean and spread.
  double sum = 0.0, squares = 0.0;
  for (std::uint64_t seed = 1; seed <= 10000; ++seed) {
    const double x = NoiseSource(seed).Normal(1.0);
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / 1e4, 0.0, 0.03);
  EXPECT_NEAR(squares / 1e4, 1.0, 0.05);
  EXPECT_NE(NoiseSource(1, 0).Next(), NoiseSource(1, 1).Next());
  EXPECT_EQ(NoiseSource(1, 1).Next(), NoiseSource(1, 1).Next());
}

}  // namespace
}  // namespace glissade::sim
