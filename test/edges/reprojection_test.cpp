// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/edges/reprojection.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "edges/edge_test_util.h"
#include "glissade/edges/reprojection_extrinsic.h"
#include "glissade/edges/reprojection_xyz.h"

namespace glissade {
namespace {

using test::ExpectJacobians;
using test::Random;

static_assert(EdgeType<EdgeReprojection> && EdgeType<EdgeReprojectionExtrinsic> &&
              EdgeType<EdgeReprojectionXYZ>);

/// A host, a target and a landmark, anywhere, but not in the plane of the target camera.
struct Scene {
  VertexPose host, target;
  VertexInverseDepth depth;
  VertexPose extrinsic;
  Vector2 uv_host, uv_target;

  Scene(Random& random, double host_angle, double target_angle, double extrinsic_angle) {
    do {
      host.pose = random.RandomPose(2.0, host_angle);
      target.pose = random.RandomPose(2.0, target_angle);
      extrinsic.pose = random.RandomPose(0.3, extrinsic_angle);
      depth.rho = random.Uniform(-0.1, 1.0);
      uv_host = random.Vec2(0.7);
      uv_target = random.Vec2(0.7);
    } while (!(std::abs(PointInTarget()[2]) > 0.3 * PointInTarget().norm()));
  }
  explicit Scene(Random& random)
      : Scene(random, random.Uniform(0, std::numbers::pi), random.Uniform(0, std::numbers::pi),
              random.Uniform(0, std::numbers::pi)) {}

  /// The formula of the docstring as it stands there, without the factor rho.
  [[nodiscard]] Vector3 PointInTarget() const {
    const Vector3 p_c = Vector3(uv_host[0], uv_host[1], 1.0) / depth.rho;
    const Vector3 p_w = host.pose * (extrinsic.pose * p_c);
    return extrinsic.pose.Inverse() * (target.pose.Inverse() * p_w);
  }
  [[nodiscard]] EdgeReprojection Edge() const {
    return EdgeReprojection{uv_host, uv_target, extrinsic.pose};
  }
  [[nodiscard]] EdgeReprojectionExtrinsic ExtrinsicEdge() const {
    return EdgeReprojectionExtrinsic{uv_host, uv_target};
  }
  [[nodiscard]] EdgeReprojectionXYZ PointEdge() const {
    return EdgeReprojectionXYZ{uv_target, extrinsic.pose};
  }
  [[nodiscard]] VertexPointXYZ Point() const {
    return VertexPointXYZ(
        host.pose * (extrinsic.pose * Vector3(Vector3(uv_host[0], uv_host[1], 1.0) / depth.rho)));
  }
};

TEST(EdgeReprojection, ResidualIsTheFormula) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Scene s(random);
    const Vector3 p = s.PointInTarget();
    const Vector2 expected = p.head<2>() / p[2] - s.uv_target;
    Vector2 r;
    ASSERT_TRUE(s.Edge().Evaluate(s.host, s.target, s.depth, r, nullptr, nullptr, nullptr));
    EXPECT_LT((r - expected).norm(), 1e-12);
    ASSERT_TRUE(s.ExtrinsicEdge().Evaluate(s.host, s.target, s.depth, s.extrinsic, r, nullptr,
                                           nullptr, nullptr, nullptr));
    EXPECT_LT((r - expected).norm(), 1e-12);
    ASSERT_TRUE(s.PointEdge().Evaluate(s.target, s.Point(), r, nullptr, nullptr));
    EXPECT_LT((r - expected).norm(), 1e-12);
  }
}

TEST(EdgeReprojection, Jacobians) {
  Random random(2);
  const auto check = [](const Scene& s) {
    ExpectJacobians(s.Edge(), s.host, s.target, s.depth);
    ExpectJacobians(s.ExtrinsicEdge(), s.host, s.target, s.depth, s.extrinsic);
    ExpectJacobians(s.PointEdge(), s.target, s.Point());
  };
  for (int trial = 0; trial < 50; ++trial)
    check(Scene(random));
  for (const double angle : test::kSpecialAngles) {
    check(Scene(random, angle, 0.7, 0.2));
    check(Scene(random, 0.7, angle, 0.2));
    check(Scene(random, 0.3, 0.7, angle));
    check(Scene(random, angle, angle, angle));
  }
}

TEST(EdgeReprojection, PointAtInfinityHasAValue) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    Scene s(random);
    s.depth.rho = 1e-13;
    Vector2 near_infinity, infinity;
    const EdgeReprojection edge = s.Edge();
    ASSERT_TRUE(edge.Evaluate(s.host, s.target, s.depth, near_infinity, nullptr, nullptr, nullptr));
    s.depth.rho = 0.0;
    ASSERT_TRUE(edge.Evaluate(s.host, s.target, s.depth, infinity, nullptr, nullptr, nullptr));
    EXPECT_LT((near_infinity - infinity).norm(), 1e-9 * (1.0 + infinity.squaredNorm()));
    if (infinity.norm() > 3.0) continue;  // too close to the camera plane for finite differences
    ExpectJacobians(edge, s.host, s.target, s.depth);
    ExpectJacobians(s.ExtrinsicEdge(), s.host, s.target, s.depth, s.extrinsic);
    Jacobian<2, 6> d_host;
    ASSERT_TRUE(edge.Evaluate(s.host, s.target, s.depth, infinity, &d_host, nullptr, nullptr));
    EXPECT_EQ((d_host.leftCols<3>().cwiseAbs().maxCoeff()), 0.0);  // no parallax
  }
}

TEST(EdgeReprojection, NoValueInTheCameraPlaneOnly) {
  // Host at the origin looking along z; the target is turned by 180 degrees: it sees the point from
  // behind, which has a value, and none once it stands exactly beside the point.
  const EdgeReprojection edge{Vector2(0.1, 0.2), Vector2::Zero(), Pose()};
  VertexPose host, target;
  const VertexInverseDepth depth{0.5};
  target.pose.p() = Vector3(0.0, 0.0, 5.0);
  Vector2 r;
  EXPECT_TRUE(edge.Evaluate(host, target, depth, r, nullptr, nullptr, nullptr));
  EXPECT_LT(edge.Depth(host, target, depth), 0.0);
  target.pose.p() = Vector3(0.0, 0.0, 2.0);
  EXPECT_FALSE(edge.Evaluate(host, target, depth, r, nullptr, nullptr, nullptr));
  const EdgeReprojectionXYZ point_edge{Vector2::Zero(), Pose()};
  EXPECT_FALSE(point_edge.Evaluate(host, VertexPointXYZ(1, 1, 0), r, nullptr, nullptr));
  EXPECT_TRUE(point_edge.Evaluate(host, VertexPointXYZ(1, 1, -1), r, nullptr, nullptr));
}

TEST(EdgeReprojection, NotFiniteIsNoValue) {
  const EdgeReprojection edge{Vector2(0.1, 0.2), Vector2::Zero(), Pose()};
  const EdgeReprojectionXYZ point_edge{Vector2::Zero(), Pose()};
  Vector2 r;
  VertexPose host, target;
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(
        edge.Evaluate(host, target, VertexInverseDepth{bad}, r, nullptr, nullptr, nullptr));
    EXPECT_FALSE(point_edge.Evaluate(host, VertexPointXYZ(bad, 0, 1), r, nullptr, nullptr));
  }
}

TEST(EdgeReprojection, Depth) {
  VertexPose host, target;
  target.pose.p() = Vector3(0.0, 0.0, -1.0);
  const EdgeReprojection edge{Vector2(0.1, 0.2), Vector2::Zero(), Pose()};
  EXPECT_DOUBLE_EQ(edge.Depth(host, target, VertexInverseDepth{0.5}), 3.0);
  EXPECT_DOUBLE_EQ(edge.Depth(host, target, VertexInverseDepth{-2.0}), -0.5);  // behind the host
  EXPECT_EQ(edge.Depth(host, target, VertexInverseDepth{0.0}),
            std::numeric_limits<double>::infinity());
  const EdgeReprojectionXYZ point_edge{Vector2::Zero(), Pose()};
  EXPECT_DOUBLE_EQ(point_edge.Depth(target, VertexPointXYZ(0.3, 0.1, 4.0)), 5.0);
}

TEST(EdgeReprojection, SameSensorIsSameExtrinsic) {
  const Pose left, right(Quaternion::Identity(), Vector3(0.1, 0.0, 0.0));
  const EdgeReprojection a{Vector2(0.1, 0.2), Vector2(0.3, 0.4), left};
  EXPECT_TRUE(a.SameSensor(EdgeReprojection{Vector2(0.9, 0.2), Vector2(0.3, 0.9), left}));
  EXPECT_FALSE(a.SameSensor(EdgeReprojection{Vector2(0.1, 0.2), Vector2(0.3, 0.4), right}));
  static_assert(EdgeReprojection::kIsObservation && EdgeReprojectionXYZ::kIsObservation);
}

TEST(EdgeReprojection, Validate) {
  EdgeReprojection edge{Vector2(0.1, 0.2), Vector2(0.3, 0.4), Pose()};
  EXPECT_TRUE(edge.Validate().ok());
  edge.uv_target[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(edge.Validate().message().substr(0, 18), "target observation");
  edge.uv_target[1] = 0.0;
  edge.T_b_c.data[6] = 0.5;
  EXPECT_EQ(edge.Validate().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(kTypeInfo<EdgeReprojection>.name, "EdgeReprojection");
}

}  // namespace
}  // namespace glissade
