// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>

#include "edges/edge_test_util.h"
#include "glissade/edges/pose_point.h"
#include "glissade/edges/pose_prior_vec.h"
#include "glissade/edges/relative_pose.h"
#include "glissade/edges/se3_prior.h"

namespace glissade {
namespace {

using test::ExpectJacobians;
using test::Random;

static_assert(EdgeType<EdgeSE3Prior> && EdgeType<EdgePosePriorVec> && EdgeType<EdgeRelativePose>);

VertexPose TurnedBy(const Pose& pose, const Vector3& phi, Random& random) {
  return VertexPose{Pose(Quaternion(pose.q() * so3::ExpQuaternion(phi)), random.Vec3(3.0))};
}

TEST(PosePriors, Residuals) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose T_w_b = random.RandomPose(3.0);
    const Vector3 phi = random.Uniform(0.0, 3.1) * random.Direction();
    const VertexPose x = TurnedBy(T_w_b, phi, random);
    Vector6 r;
    ASSERT_TRUE(EdgeSE3Prior{T_w_b}.Evaluate(x, r, nullptr));
    EXPECT_LT((r.head<3>() - (x.pose.p() - T_w_b.p())).norm(), 1e-15);
    EXPECT_LT((r.tail<3>() - phi).norm(), 1e-13);
    ASSERT_TRUE(EdgePosePriorVec{T_w_b}.Evaluate(x, r, nullptr));
    EXPECT_LT((r.head<3>() - (x.pose.p() - T_w_b.p())).norm(), 1e-15);
    EXPECT_LT((r.tail<3>() - 2.0 * std::sin(0.5 * phi.norm()) * phi.normalized()).norm(), 1e-14);

    // -q is the same rotation and must give the same residual.
    VertexPose minus = x;
    for (int i = 3; i < 7; ++i)
      minus.pose.data[i] = -minus.pose.data[i];
    Vector6 r_minus;
    ASSERT_TRUE(EdgePosePriorVec{T_w_b}.Evaluate(minus, r_minus, nullptr));
    EXPECT_EQ(r, r_minus);
    ExpectJacobians(EdgePosePriorVec{T_w_b}, minus);
    ExpectJacobians(EdgeSE3Prior{T_w_b}, minus);
  }
}

TEST(PosePriors, SE3PriorIsMinusOfTheVertex) {
  Random random(2);
  const VertexPose x{random.RandomPose(3.0)}, x0{random.RandomPose(3.0)};
  Vector6 r, minus;
  ASSERT_TRUE(EdgeSE3Prior{x0.pose}.Evaluate(x, r, nullptr));
  x.Minus(x0, minus.data());
  EXPECT_EQ(r, minus);
}

TEST(PosePriors, Jacobians) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose T_w_b = random.RandomPose(3.0);
    const VertexPose x{random.RandomPose(3.0)};
    ExpectJacobians(EdgeSE3Prior{T_w_b}, x);
    ExpectJacobians(EdgePosePriorVec{T_w_b}, x);
  }
  for (const double angle : test::kSpecialAngles) {
    for (int trial = 0; trial < 5; ++trial) {
      const Pose T_w_b = random.RandomPose(3.0);
      const VertexPose x = TurnedBy(T_w_b, angle * random.Direction(), random);
      SCOPED_TRACE(angle);
      ExpectJacobians(EdgeSE3Prior{T_w_b}, x);
      ExpectJacobians(EdgePosePriorVec{T_w_b}, x);
    }
  }
}

TEST(EdgeRelativePose, Residual) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose T_w_i = random.RandomPose(3.0), T_i_j = random.RandomPose(3.0);
    const Vector3 dp = random.Vec3(1.0), phi = random.Uniform(0.0, 3.1) * random.Direction();
    const Pose T_w_j =
        T_w_i * Pose(Quaternion(T_i_j.q() * so3::ExpQuaternion(phi)), Vector3(T_i_j.p() + dp));
    Vector6 r;
    ASSERT_TRUE(EdgeRelativePose{T_i_j}.Evaluate(VertexPose{T_w_i}, VertexPose{T_w_j}, r, nullptr,
                                                 nullptr));
    EXPECT_LT((r.head<3>() - dp).norm(), 1e-13);
    EXPECT_LT((r.tail<3>() - phi).norm(), 1e-13);
  }
}

TEST(EdgeRelativePose, Jacobians) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    ExpectJacobians(EdgeRelativePose{random.RandomPose(3.0)}, VertexPose{random.RandomPose(3.0)},
                    VertexPose{random.RandomPose(3.0)});
  }
  for (const double angle : test::kSpecialAngles) {
    SCOPED_TRACE(angle);
    const Pose T_w_i = random.RandomPose(3.0), T_i_j = random.RandomPose(3.0);
    ExpectJacobians(EdgeRelativePose{T_i_j}, VertexPose{T_w_i},
                    TurnedBy(T_w_i * T_i_j, angle * random.Direction(), random));
    ExpectJacobians(EdgeRelativePose{random.RandomPose(3.0, angle)},
                    VertexPose{random.RandomPose(3.0, angle)}, VertexPose{random.RandomPose(3.0)});
  }
}

TEST(EdgePosePoint, ResidualAndJacobians) {
  static_assert(EdgeType<EdgePosePoint> && kEvaluatesInPacks<EdgePosePoint>);
  Random random(6);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose T_w_b = random.RandomPose(3.0), T_b_s = random.RandomPose(1.0);
    const Vector3 p_s = random.Vec3(5.0), error = random.Vec3(0.5);
    const VertexPointXYZ point(T_w_b * (T_b_s * Vector3(p_s + error)));
    const EdgePosePoint edge{p_s, T_b_s};
    Vector3 r;
    ASSERT_TRUE(edge.Evaluate(VertexPose{T_w_b}, point, r, nullptr, nullptr));
    EXPECT_LT((r - error).norm(), 1e-13);
    ExpectJacobians(edge, VertexPose{T_w_b}, point);
  }
  Vector3 r;
  VertexPointXYZ nowhere;
  nowhere.data[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(EdgePosePoint{}.Evaluate(VertexPose{}, nowhere, r, nullptr, nullptr));
  EXPECT_TRUE(EdgePosePoint{}.Validate().ok());
  EXPECT_EQ((EdgePosePoint{Vector3(nowhere.p()), Pose()}).Validate().code(),
            StatusCode::kNotFinite);
}

TEST(PoseEdges, Validate) {
  EXPECT_TRUE(EdgeSE3Prior{}.Validate().ok());
  Pose bad;
  bad.data[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(EdgeSE3Prior{bad}.Validate().code(), StatusCode::kNotFinite);
  EXPECT_EQ(EdgePosePriorVec{bad}.Validate().code(), StatusCode::kNotFinite);
  EXPECT_EQ(EdgeRelativePose{bad}.Validate().code(), StatusCode::kNotFinite);
  bad = Pose();
  bad.data[6] = 2.0;
  EXPECT_EQ(EdgeRelativePose{bad}.Validate().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace glissade
