// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/edges/imu.h"

#include <gtest/gtest.h>

#include <limits>

#include "edges/edge_test_util.h"
#include "glissade/edges/speed_bias_prior.h"

namespace glissade {
namespace {

using test::ExpectJacobians;
using test::Random;

static_assert(EdgeType<EdgeImu> && EdgeType<EdgeSpeedBiasPrior>);

Matrix3 RandomMatrix(Random& random, double size) {
  Matrix3 m;
  for (int i = 0; i < 9; ++i)
    m(i / 3, i % 3) = random.Uniform(-size, size);
  return m;
}

VertexSpeedBias RandomSpeedBias(Random& random) {
  const Vector3 v = random.Vec3(2.0), ba = random.Vec3(0.3);
  return {v, ba, random.Vec3(0.1)};
}

EdgeImu RandomEdge(Random& random, double angle) {
  EdgeImu edge;
  edge.imu.dt = random.Uniform(0.05, 1.0);
  edge.imu.dp = random.Vec3(1.0);
  edge.imu.dq = random.Rotation(angle);
  edge.imu.dv = random.Vec3(2.0);
  edge.imu.ba_lin = random.Vec3(0.3);
  edge.imu.bg_lin = random.Vec3(0.1);
  edge.imu.dp_dba = RandomMatrix(random, 0.5);
  edge.imu.dp_dbg = RandomMatrix(random, 0.5);
  edge.imu.dq_dbg = RandomMatrix(random, 1.0);
  edge.imu.dv_dba = RandomMatrix(random, 1.0);
  edge.imu.dv_dbg = RandomMatrix(random, 1.0);
  edge.gravity = random.Vec3(10.0);
  return edge;
}

/// The states at which all but the biases' rows vanish: integrates the edge's own measurement.
void Predict(const EdgeImu& edge, const VertexPose& pose_i, const VertexSpeedBias& sb_i,
             VertexPose& pose_j, VertexSpeedBias& sb_j) {
  const PreintegratedImu& m = edge.imu;
  const Vector3 dba = sb_i.ba() - m.ba_lin, dbg = sb_i.bg() - m.bg_lin;
  const Matrix3 R_i = pose_i.pose.R();
  const Vector3 dp = m.dp + m.dp_dba * dba + m.dp_dbg * dbg;
  const Vector3 dv = m.dv + m.dv_dba * dba + m.dv_dbg * dbg;
  const Matrix3 dR = RotationMatrix(m.dq.coeffs().data()) * so3::Exp(m.dq_dbg * dbg);
  const Vector3 p = pose_i.pose.p() + m.dt * sb_i.v() + 0.5 * m.dt * m.dt * edge.gravity + R_i * dp;
  pose_j.pose = Pose(Matrix3(R_i * dR), p);
  sb_j = VertexSpeedBias(sb_i.v() + m.dt * edge.gravity + R_i * dv, sb_i.ba(), sb_i.bg());
}

TEST(EdgeImu, VanishesAtTheIntegratedState) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const EdgeImu edge = RandomEdge(random, random.Uniform(0.0, 3.0));
    const VertexPose pose_i{random.RandomPose(5.0)};
    const VertexSpeedBias sb_i = RandomSpeedBias(random);
    VertexPose pose_j;
    VertexSpeedBias sb_j;
    Predict(edge, pose_i, sb_i, pose_j, sb_j);
    Vector<15> r;
    ASSERT_TRUE(edge.Evaluate(pose_i, sb_i, pose_j, sb_j, r, nullptr, nullptr, nullptr, nullptr));
    EXPECT_LT(r.cwiseAbs().maxCoeff(), 1e-13);

    // Errors added by hand come back in their rows: p, theta, v, ba, bg.
    const Vector3 p = random.Vec3(0.1), v = random.Vec3(0.1), ba = random.Vec3(0.1);
    const Vector3 bg = random.Vec3(0.1), phi = random.Uniform(0.0, 3.0) * random.Direction();
    VertexPose moved = pose_j;
    moved.pose.p() += pose_i.pose.R() * p;
    moved.pose.q() = moved.pose.q() * so3::ExpQuaternion(phi);
    const VertexSpeedBias sb_moved(sb_j.v() + pose_i.pose.R() * v, sb_j.ba() + ba, sb_j.bg() + bg);
    ASSERT_TRUE(
        edge.Evaluate(pose_i, sb_i, moved, sb_moved, r, nullptr, nullptr, nullptr, nullptr));
    Vector<15> expected;
    expected << p, 2.0 * std::sin(0.5 * phi.norm()) * phi.normalized(), v, ba, bg;
    EXPECT_LT((r - expected).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(EdgeImu, SignOfTheQuaternionDoesNotMatter) {
  Random random(2);
  const EdgeImu edge = RandomEdge(random, 1.0);
  const VertexPose pose_i{random.RandomPose(5.0)}, pose_j{random.RandomPose(5.0)};
  const VertexSpeedBias sb_i = RandomSpeedBias(random), sb_j = RandomSpeedBias(random);
  VertexPose minus = pose_j;
  for (int i = 3; i < 7; ++i)
    minus.pose.data[i] *= -1.0;
  Vector<15> r, r_minus;
  edge.Evaluate(pose_i, sb_i, pose_j, sb_j, r, nullptr, nullptr, nullptr, nullptr);
  edge.Evaluate(pose_i, sb_i, minus, sb_j, r_minus, nullptr, nullptr, nullptr, nullptr);
  EXPECT_EQ(r, r_minus);
  ExpectJacobians(edge, pose_i, sb_i, minus, sb_j);
}

TEST(EdgeImu, Jacobians) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const EdgeImu edge = RandomEdge(random, random.Uniform(0.0, 3.1));
    ExpectJacobians(edge, VertexPose{random.RandomPose(5.0)}, RandomSpeedBias(random),
                    VertexPose{random.RandomPose(5.0)}, RandomSpeedBias(random));
  }
  for (const double angle : test::kSpecialAngles) {
    SCOPED_TRACE(angle);
    // Orientation error of this angle, small rotations of the states, no change of bias: all the
    // places where a formula divides by an angle.
    EdgeImu edge = RandomEdge(random, angle);
    const VertexPose pose_i{random.RandomPose(5.0, angle)};
    VertexSpeedBias sb_i = RandomSpeedBias(random);
    VertexPose pose_j;
    VertexSpeedBias sb_j;
    Predict(edge, pose_i, sb_i, pose_j, sb_j);
    pose_j.pose.q() = pose_j.pose.q() * random.Rotation(angle);
    ExpectJacobians(edge, pose_i, sb_i, pose_j, sb_j);
    edge.imu.bg_lin = sb_i.bg();
    edge.imu.ba_lin = sb_i.ba();
    Predict(edge, pose_i, sb_i, pose_j, sb_j);
    pose_j.pose.q() = pose_j.pose.q() * random.Rotation(angle);
    ExpectJacobians(edge, pose_i, sb_i, pose_j, sb_j);
  }
}

TEST(EdgeImu, Validate) {
  Random random(4);
  const EdgeImu good = RandomEdge(random, 0.3);
  EXPECT_TRUE(good.Validate().ok());
  EdgeImu bad = good;
  bad.imu.dt = 0.0;
  EXPECT_EQ(bad.Validate().code(), StatusCode::kNotPositive);
  bad = good;
  bad.imu.dv_dbg(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(bad.Validate().code(), StatusCode::kNotFinite);
  bad = good;
  bad.imu.dq.w() += 0.5;
  EXPECT_EQ(bad.Validate().code(), StatusCode::kInvalidArgument);
  bad = good;
  bad.gravity[1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(bad.Validate().code(), StatusCode::kNotFinite);
}

TEST(EdgeSpeedBiasPrior, ResidualAndJacobian) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const EdgeSpeedBiasPrior edge{RandomSpeedBias(random)};
    const VertexSpeedBias x = RandomSpeedBias(random);
    Vector<9> r;
    ASSERT_TRUE(edge.Evaluate(x, r, nullptr));
    EXPECT_EQ(r[4], x.data[4] - edge.prior.data[4]);
    ExpectJacobians(edge, x);
  }
}

}  // namespace
}  // namespace glissade
