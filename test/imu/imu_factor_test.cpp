// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/imu/imu_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "common/random_states.h"
#include "glissade/graph/graph.h"
#include "glissade/imu/reintegration.h"
#include "glissade/testing.h"
#include "imu/imu_signal.h"

namespace glissade {
namespace {

using test::Random;

struct Scene {
  ImuPreintegration preintegration;
  ImuFactor factor;
  VertexPose pose_i, pose_j;
  VertexSpeedBias sb_i, sb_j;
};

/// Biases a little off those of the integration, states a little off the prediction.
Scene MakeScene(std::uint64_t seed, double offset) {
  Random random(seed);
  Scene s;
  s.preintegration =
      *Preintegrate(test::Samples(60, 5'000'000), {random.Vec3(0.2), random.Vec3(0.05)}, {});
  s.factor = *MakeImuFactor(s.preintegration);
  s.pose_i.pose = random.RandomPose(5.0);
  s.sb_i = VertexSpeedBias(random.Vec3(2.0), s.preintegration.imu.ba_lin + random.Vec3(offset),
                           s.preintegration.imu.bg_lin + random.Vec3(offset));
  const ImuPrediction next = Predict(s.factor.edge, s.pose_i, s.sb_i);
  s.pose_j = next.pose;
  s.sb_j = next.speed_bias;
  double delta[9];
  for (double& x : delta)
    x = random.Uniform(-offset, offset);
  s.pose_j.Plus(delta);
  s.sb_j.Plus(delta);
  return s;
}

TEST(ImuFactor, EveryJacobianNumerically) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene s = MakeScene(seed, 0.02);
    const auto check = CheckJacobians(s.factor.edge, s.pose_i, s.sb_i, s.pose_j, s.sb_j);
    EXPECT_TRUE(check.ok) << check.message;
  }
}

TEST(ImuFactor, PredictionHasNoResidual) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Scene s = MakeScene(seed, 0.02);
    s.factor.edge.gravity = Vector3(0.3, -0.2, -9.7);
    const ImuPrediction next = Predict(s.factor.edge, s.pose_i, s.sb_i);
    Vector<15> r;
    ASSERT_TRUE(s.factor.edge.Evaluate(s.pose_i, s.sb_i, next.pose, next.speed_bias, r, nullptr,
                                       nullptr, nullptr, nullptr));
    EXPECT_LT(r.norm(), 1e-13);
  }
}

TEST(ImuFactor, PredictionFollowsTheMotion) {
  // Against integration of the world's equations of motion, not of increments.
  Random random(3);
  const VertexPose start{random.RandomPose(5.0)};
  const VertexSpeedBias sb(random.Vec3(2.0), Vector3::Zero(), Vector3::Zero());
  const auto samples = test::Samples(1000, 500'000);
  const auto factor = MakeImuFactor(*Preintegrate(samples, {}, {}));
  ASSERT_TRUE(factor.ok());
  const ImuPrediction next = Predict(factor->edge, start, sb);
  const Quaternion q0 = start.pose.q();
  const test::Increments world =
      test::IntegrateFinely(test::GyroAt, [&](double t) -> Vector3 { return test::AccelAt(t); },
                            0.0, 0.5, 5000, {.q = q0, .v = Vector3::Zero(), .p = Vector3::Zero()});
  const Vector3 g = factor->edge.gravity;
  EXPECT_LT((next.speed_bias.v() - (sb.v() + world.v + 0.5 * g)).norm(), 1e-6);
  EXPECT_LT((next.pose.pose.p() - (start.pose.p() + 0.5 * sb.v() + world.p + 0.125 * g)).norm(),
            1e-6);
  EXPECT_LT(so3::Log(Quaternion(next.pose.pose.q().conjugate() * world.q)).norm(), 1e-6);
}

TEST(ImuFactor, SqrtInformationInvertsTheCovariance) {
  const Scene s = MakeScene(1, 0.01);
  const Eigen::Matrix<double, 15, 15> U = *s.factor.options.sqrt_information;
  const Eigen::Matrix<double, 15, 15> P = s.preintegration.covariance;
  EXPECT_TRUE(U.isUpperTriangular(0.0));
  const Eigen::Matrix<double, 15, 15> I = U * P * U.transpose();
  EXPECT_LT((I - Eigen::Matrix<double, 15, 15>::Identity()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ImuFactor, RefusesACovarianceThatIsNone) {
  ImuPreintegration x = MakeScene(1, 0.01).preintegration;
  SquareMatrix<15> U = SquareMatrix<15>::Identity();
  const auto refused = [&](auto&& spoil, StatusCode code) {
    SquareMatrix<15> P = x.covariance;
    spoil(P);
    EXPECT_EQ(SqrtInformationOf(P, &U).code(), code);
    EXPECT_EQ(U, (SquareMatrix<15>(SquareMatrix<15>::Identity())));  // untouched
    ImuPreintegration y = x;
    y.covariance = P;
    EXPECT_FALSE(MakeImuFactor(y).ok());
  };
  using M = SquareMatrix<15>;
  refused([](M& P) { P(3, 3) = 0.0; }, StatusCode::kNotPositive);
  refused([](M& P) { P(14, 14) = -1e-9; }, StatusCode::kNotPositive);
  refused([](M& P) { P(0, 1) = std::nan(""); }, StatusCode::kNotFinite);
  refused([](M& P) { P(2, 2) = std::numeric_limits<double>::infinity(); }, StatusCode::kNotFinite);
  refused([](M& P) { P(0, 1) = P(1, 0) = std::sqrt(P(0, 0) * P(1, 1)); }, StatusCode::kNotPositive);
  refused([](M& P) { P.setZero(); }, StatusCode::kNotPositive);
  refused([](M& P) { P *= 1e-320; }, StatusCode::kNotPositive);
  refused([](M& P) { P(0, 0) = 1e-310; }, StatusCode::kNotPositive);
  EXPECT_FALSE(MakeImuFactor(ImuPreintegration{}).ok());
}

TEST(ImuFactor, GoesIntoAGraph) {
  const Scene s = MakeScene(4, 0.01);
  Graph graph;
  const auto pose_i = graph.AddVertex(s.pose_i), pose_j = graph.AddVertex(s.pose_j);
  const auto sb_i = graph.AddVertex(s.sb_i), sb_j = graph.AddVertex(s.sb_j);
  const auto edge = graph.AddEdge(s.factor.edge, {pose_i, sb_i, pose_j, sb_j}, s.factor.options);
  ASSERT_TRUE(edge.ok()) << edge.status().message();
  Vector<15> r;
  s.factor.edge.Evaluate(s.pose_i, s.sb_i, s.pose_j, s.sb_j, r, nullptr, nullptr, nullptr, nullptr);
  const Eigen::Matrix<double, 15, 1> e = r;
  const Eigen::Matrix<double, 15, 15> P = s.preintegration.covariance;
  const double chi2 = e.dot(P.fullPivLu().solve(e));
  EXPECT_NEAR(graph.Chi2(edge.value()).value() / chi2, 1.0, 1e-9);
}

TEST(Reintegration, EstimateOfTheCorrectionsErrorIsRightWithinASmallFactor) {
  const auto samples = test::Samples(100, 5'000'000);
  const ImuPreintegration middle = *Preintegrate(samples, {}, {});
  double most_p = 0.0, most_theta = 0.0, most_v = 0.0;
  Random random(9);
  for (int k = 0; k < 200; ++k) {
    const ImuBias bias{random.Uniform(0.0, 0.3) * random.Direction(),
                       random.Uniform(0.01, 0.05) * random.Direction()};
    const PreintegratedImu again = Preintegrate(samples, bias, {})->imu;
    const PreintegratedImu& imu = middle.imu;
    const Vector3 dp = imu.dp + imu.dp_dba * bias.ba + imu.dp_dbg * bias.bg;
    const Vector3 dv = imu.dv + imu.dv_dba * bias.ba + imu.dv_dbg * bias.bg;
    const Quaternion dq = imu.dq * so3::ExpQuaternion(imu.dq_dbg * bias.bg);
    const ImuIncrementError error = BiasCorrectionError(middle, bias);
    most_p = std::max(most_p, (dp - again.dp).norm() / error.p);
    most_v = std::max(most_v, (dv - again.dv).norm() / error.v);
    most_theta =
        std::max(most_theta, so3::Log(Quaternion(dq.conjugate() * again.dq)).norm() / error.theta);
  }
  for (const double most : {most_p, most_theta, most_v}) {
    EXPECT_LT(most, 3.0);
    EXPECT_GT(most, 0.3);
  }
}

TEST(Reintegration, AsksWhereTheCorrectionIsNoLongerGoodEnough) {
  const auto samples = test::Samples(100, 5'000'000);
  const ImuPreintegration x = *Preintegrate(samples, {}, {});
  EXPECT_FALSE(NeedsReintegration(x, {}));
  EXPECT_FALSE(NeedsReintegration(x, {Vector3(0.05, 0, 0), Vector3(0.001, 0, 0)}));
  EXPECT_TRUE(NeedsReintegration(x, {Vector3::Zero(), Vector3(0.1, 0, 0)}));
  EXPECT_TRUE(NeedsReintegration(x, {Vector3::Zero(), Vector3(std::nan(""), 0, 0)}));
  // Where it does not ask, the first-order correction is within a fraction of a sigma of the
  // integral at the new bias: Chi2 between the two is small.
  Random random(5);
  int asked = 0;
  for (int k = 0; k < 200; ++k) {
    const ImuBias bias{random.Vec3(0.1), random.Vec3(0.01)};
    if (NeedsReintegration(x, bias)) {
      ++asked;
      continue;
    }
    const auto again = MakeImuFactor(*Preintegrate(samples, bias, {}));
    const auto corrected = MakeImuFactor(x);
    const VertexPose pose;
    const VertexSpeedBias sb(Vector3::Zero(), bias.ba, bias.bg);
    const ImuPrediction next = Predict(corrected->edge, pose, sb);
    Vector<15> r;
    again->edge.Evaluate(pose, sb, next.pose, next.speed_bias, r, nullptr, nullptr, nullptr,
                         nullptr);
    const Vector<15> whitened = *again->options.sqrt_information * r;
    EXPECT_LT(whitened.squaredNorm(), 0.5);
  }
  EXPECT_GT(asked, 20);
  EXPECT_LT(asked, 180);
}

}  // namespace
}  // namespace glissade
