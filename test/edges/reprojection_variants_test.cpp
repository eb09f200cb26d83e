// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Stereo, time offset, calibration and camera models: each against the plain formula, each against
// numeric derivatives.
#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "edges/edge_test_util.h"
#include "glissade/cameras/kannala_brandt.h"
#include "glissade/cameras/pinhole.h"
#include "glissade/cameras/radtan.h"
#include "glissade/edges/reprojection.h"
#include "glissade/edges/reprojection_calibration.h"
#include "glissade/edges/reprojection_extrinsic.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_stereo_same.h"
#include "glissade/edges/reprojection_time_offset.h"
#include "glissade/edges/reprojection_xyz.h"

namespace glissade {
namespace {

using test::ExpectJacobians;
using test::Random;

/// Two frames, two cameras on the body, one landmark in a cone about the target's axis.
struct Scene {
  VertexPose i, j;
  VertexInverseDepth depth;
  Pose T_b_left, T_b_right;
  Vector2 uv, velocity_i, velocity_j;
  double td_i, td_j;
  VertexVector<1> td;

  Scene(Random& random, double angle, double largest_xy) {
    do {
      i.pose = random.RandomPose(2.0, angle);
      j.pose = random.RandomPose(2.0);
      T_b_left = random.RandomPose(0.3, angle);
      T_b_right = random.RandomPose(0.3);
      depth.rho = random.Uniform(0.05, 1.0);
      uv = random.Vec2(0.7);
      velocity_i = random.Vec2(0.5);
      velocity_j = random.Vec2(0.5);
      td_i = random.Uniform(-0.02, 0.02);
      td_j = random.Uniform(-0.02, 0.02);
      td.value[0] = random.Uniform(-0.02, 0.02);
    } while (!InCone(Point(uv, i, j, T_b_left, T_b_left), largest_xy) ||
             !InCone(Point(uv, i, j, T_b_left, T_b_right), largest_xy) ||
             !InCone(Point(uv, i, i, T_b_left, T_b_right), largest_xy));
  }

  static bool InCone(const Vector3& p, double largest_xy) {
    return p[2] > 0.1 && p.head<2>().norm() < largest_xy * p[2];
  }

  [[nodiscard]] Vector3 Point(const Vector2& b, const VertexPose& host, const VertexPose& target,
                              const Pose& T_b_host, const Pose& T_b_target) const {
    const Vector3 p_c = Vector3(b[0], b[1], 1.0) / depth.rho;
    return T_b_target.Inverse() * (target.pose.Inverse() * (host.pose * (T_b_host * p_c)));
  }
  [[nodiscard]] Vector2 Xy(const VertexPose& target, const Pose& T_b_target) const {
    const Vector3 p = Point(uv, i, target, T_b_left, T_b_target);
    return p.head<2>() / p[2];
  }
};

std::vector<Scene> Scenes(std::uint64_t seed, double largest_xy) {
  Random random(seed);
  std::vector<Scene> scenes;
  for (int trial = 0; trial < 50; ++trial) {
    scenes.emplace_back(random, random.Uniform(0.0, std::numbers::pi), largest_xy);
  }
  for (const double angle : test::kSpecialAngles)
    scenes.emplace_back(random, angle, largest_xy);
  return scenes;
}

TEST(EdgeReprojectionStereo, AnotherFrame) {
  for (const Scene& s : Scenes(1, 2.0)) {
    const EdgeReprojectionStereo edge{s.uv, Vector2(0.1, 0.2), s.T_b_left, s.T_b_right};
    Vector2 r;
    ASSERT_TRUE(edge.Evaluate(s.i, s.j, s.depth, r, nullptr, nullptr, nullptr));
    EXPECT_LT((r + edge.uv_target - s.Xy(s.j, s.T_b_right)).norm(), 1e-12);
    ExpectJacobians(edge, s.i, s.j, s.depth);
    ExpectJacobians(edge, s.i, s.j, VertexInverseDepth{0.0});
    EXPECT_NEAR(edge.Depth(s.i, s.j, s.depth), s.Point(s.uv, s.i, s.j, s.T_b_left, s.T_b_right)[2],
                1e-12);

    const EdgeReprojectionStereo mono{s.uv, Vector2(0.1, 0.2), s.T_b_left, s.T_b_left};
    Vector2 r_mono;
    ASSERT_TRUE(mono.Evaluate(s.i, s.j, s.depth, r_mono, nullptr, nullptr, nullptr));
    ASSERT_TRUE((EdgeReprojection{s.uv, Vector2(0.1, 0.2), s.T_b_left}.Evaluate(
        s.i, s.j, s.depth, r, nullptr, nullptr, nullptr)));
    EXPECT_LT((r - r_mono).norm(), 1e-15);
    EXPECT_FALSE(edge.SameSensor(mono));
    EXPECT_TRUE(edge.SameSensor(edge));
  }
}

TEST(EdgeReprojectionStereo, SameFrame) {
  for (const Scene& s : Scenes(2, 2.0)) {
    const EdgeReprojectionStereoSame edge{s.uv, Vector2(0.1, 0.2), s.T_b_left, s.T_b_right};
    Vector2 r;
    ASSERT_TRUE(edge.Evaluate(s.depth, r, nullptr));
    EXPECT_LT((r + edge.uv_target - s.Xy(s.i, s.T_b_right)).norm(), 1e-11);
    ExpectJacobians(edge, s.depth);
    ExpectJacobians(edge, VertexInverseDepth{0.0});
    EXPECT_NEAR(edge.Depth(s.depth), s.Point(s.uv, s.i, s.i, s.T_b_left, s.T_b_right)[2], 1e-12);
  }
}

TEST(EdgeReprojectionTimeOffset, MovesBothObservations) {
  for (const Scene& s : Scenes(3, 2.0)) {
    const EdgeReprojectionTimeOffset edge{
        {s.uv, s.velocity_i, s.td_i}, {Vector2(0.1, 0.2), s.velocity_j, s.td_j}, s.T_b_left};
    const double td = s.td.value[0];
    const Vector2 uv_i = s.uv - (td - s.td_i) * s.velocity_i;
    const Vector2 uv_j = Vector2(0.1, 0.2) - (td - s.td_j) * s.velocity_j;
    Vector2 r, expected;
    ASSERT_TRUE(edge.Evaluate(s.i, s.j, s.depth, s.td, r, nullptr, nullptr, nullptr, nullptr));
    ASSERT_TRUE((EdgeReprojection{uv_i, uv_j, s.T_b_left}.Evaluate(s.i, s.j, s.depth, expected,
                                                                   nullptr, nullptr, nullptr)));
    EXPECT_LT((r - expected).norm(), 1e-14);
    ExpectJacobians(edge, s.i, s.j, s.depth, s.td);
    EXPECT_DOUBLE_EQ(edge.Depth(s.i, s.j, s.depth, s.td),
                     (EdgeReprojection{uv_i, uv_j, s.T_b_left}.Depth(s.i, s.j, s.depth)));

    const EdgeReprojectionCalibration both{edge.host, edge.target};
    const VertexPose extrinsic{s.T_b_left};
    ASSERT_TRUE(both.Evaluate(s.i, s.j, s.depth, extrinsic, s.td, r, nullptr, nullptr, nullptr,
                              nullptr, nullptr));
    EXPECT_LT((r - expected).norm(), 1e-14);
    ExpectJacobians(both, s.i, s.j, s.depth, extrinsic, s.td);
  }
}

/// A camera that moves along x past a wall: the offset that explains the shift in the image is the
/// true one. Fixes the sign of td.
TEST(EdgeReprojectionTimeOffset, SignOfTheOffset) {
  const double speed = 2.0, z = 4.0, td_true = 0.015;
  // Body time = camera stamp + td. Images stamped 0 and 1 are exposed at body times td and 1 + td,
  // while the states (made believing td_0 = 0) are those of body times 0 and 1.
  VertexPose i, j;
  j.pose.p() = Vector3(speed, 0.0, 0.0);
  const auto seen_at = [&](double body_time) {
    return Vector2((1.0 - speed * body_time) / z, 0.0);
  };
  const Vector2 velocity(-speed / z, 0.0);
  const EdgeReprojectionTimeOffset edge{
      {seen_at(td_true), velocity}, {seen_at(1.0 + td_true), velocity}, Pose()};
  Vector2 r;
  ASSERT_TRUE(edge.Evaluate(i, j, VertexInverseDepth{1.0 / z}, VertexVector<1>{{td_true}}, r,
                            nullptr, nullptr, nullptr, nullptr));
  EXPECT_LT(r.norm(), 1e-15);
  EXPECT_EQ(edge.host.At(td_true), seen_at(0.0));
  EXPECT_EQ(edge.host.At(0.0), edge.host.uv);
}

template <class Camera>
void CheckEdgesWithCamera(const Camera& camera, double largest_xy) {
  for (const Scene& s : Scenes(4, largest_xy)) {
    const Vector2 measured(320.0, 240.0);
    const Vector3 p = s.Point(s.uv, s.i, s.j, s.T_b_left, s.T_b_left);
    Vector2 expected, r;
    ASSERT_TRUE(camera.Project(p, expected, nullptr));
    const EdgeReprojectionOf<Camera> edge{s.uv, measured, s.T_b_left, camera};
    ASSERT_TRUE(edge.Evaluate(s.i, s.j, s.depth, r, nullptr, nullptr, nullptr));
    EXPECT_LT((r - (expected - measured)).norm(), 1e-9);
    ExpectJacobians(edge, s.i, s.j, s.depth);

    const VertexPose extrinsic{s.T_b_left};
    ExpectJacobians(EdgeReprojectionExtrinsicOf<Camera>{s.uv, measured, camera}, s.i, s.j, s.depth,
                    extrinsic);
    ExpectJacobians(
        EdgeReprojectionStereoOf<Camera>{s.uv, measured, s.T_b_left, s.T_b_right, camera}, s.i, s.j,
        s.depth);
    ExpectJacobians(
        EdgeReprojectionStereoSameOf<Camera>{s.uv, measured, s.T_b_left, s.T_b_right, camera},
        s.depth);
    const TimedObservation host{s.uv, s.velocity_i, s.td_i};
    const TimedObservation target{measured, 100.0 * s.velocity_j, s.td_j};
    ExpectJacobians(EdgeReprojectionTimeOffsetOf<Camera>{host, target, s.T_b_left, camera}, s.i,
                    s.j, s.depth, s.td);
    ExpectJacobians(EdgeReprojectionCalibrationOf<Camera>{host, target, camera}, s.i, s.j, s.depth,
                    extrinsic, s.td);
    const VertexPointXYZ point(
        s.i.pose * (s.T_b_left * Vector3(Vector3(s.uv[0], s.uv[1], 1.0) / s.depth.rho)));
    const EdgeReprojectionXYZOf<Camera> point_edge{measured, s.T_b_left, camera};
    ASSERT_TRUE(point_edge.Evaluate(s.j, point, r, nullptr, nullptr));
    EXPECT_LT((r - (expected - measured)).norm(), 1e-9);
    ExpectJacobians(point_edge, s.j, point);
  }
}

TEST(EdgesWithCameraModels, Pinhole) {
  CheckEdgesWithCamera(CameraPinhole{458.6, 457.3, 367.2, 248.4}, 2.0);
}
TEST(EdgesWithCameraModels, Radtan) {
  CheckEdgesWithCamera(CameraRadtan{{458.6, 457.3, 367.2, 248.4}, -0.283, 0.0740, 0.0002, 1.8e-5},
                       0.8);
}
TEST(EdgesWithCameraModels, KannalaBrandt) {
  CheckEdgesWithCamera(
      CameraKannalaBrandt{{190.98, 190.97, 254.9, 256.9}, 0.0035, 0.0007, -0.0021, 0.0002}, 8.0);
}

TEST(EdgesWithCameraModels, FisheyeKnowsFrontFromBack) {
  // rho < 0 puts the point behind the host; a fisheye sees it where it is, not mirrored.
  const CameraKannalaBrandt camera{{100.0, 100.0, 0.0, 0.0}};
  const Pose right(Quaternion::Identity(), Vector3(0.5, 0.0, 0.0));
  const EdgeReprojectionStereoSameOf<CameraKannalaBrandt> edge{Vector2(0.2, 0.1), Vector2::Zero(),
                                                               Pose(), right, camera};
  const VertexInverseDepth depth{-0.5};
  Vector2 r, expected;
  ASSERT_TRUE(edge.Evaluate(depth, r, nullptr));
  ASSERT_TRUE(camera.Project(Vector3(-0.4 - 0.5, -0.2, -2.0), expected, nullptr));
  EXPECT_LT((r - expected).norm(), 1e-12);
  ExpectJacobians(edge, depth);
  EXPECT_LT(edge.Depth(depth), 0.0);
}

}  // namespace
}  // namespace glissade
