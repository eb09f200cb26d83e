// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/edges/bal.h"

#include <gtest/gtest.h>

#include <limits>

#include "edges/edge_test_util.h"

namespace glissade {
namespace {

using test::ExpectJacobians;
using test::Random;

static_assert(EdgeType<EdgeBal>);

VertexCameraBal RandomCamera(Random& random, double angle) {
  VertexCameraBal camera;
  const Vector3 omega = angle * random.Direction(), t = random.Vec3(3.0);
  for (int i = 0; i < 3; ++i)
    camera.data[i] = omega[i];
  for (int i = 0; i < 3; ++i)
    camera.data[3 + i] = t[i];
  camera.data[6] = random.Uniform(300.0, 800.0);
  camera.data[7] = random.Uniform(-0.3, 0.3);
  camera.data[8] = random.Uniform(-0.1, 0.1);
  return camera;
}

Vector3 InCamera(const VertexCameraBal& camera, const VertexPointXYZ& point) {
  const double* c = camera.data;
  const Vector3 omega(c[0], c[1], c[2]);
  return RotationMatrix(so3::ExpQuaternion(omega).coeffs().data()) * point.p() +
         Vector3(c[3], c[4], c[5]);
}

VertexPointXYZ RandomPoint(Random& random, const VertexCameraBal& camera) {
  for (;;) {
    const VertexPointXYZ point(random.Vec3(10.0));
    const Vector3 p = InCamera(camera, point);
    if (std::abs(p[2]) > 0.5 * p.norm()) return point;
  }
}

TEST(EdgeBal, ResidualIsTheFormulaAlsoBehindTheCamera) {
  Random random(1);
  int behind = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const VertexCameraBal camera = RandomCamera(random, random.Uniform(0.0, 3.1));
    const VertexPointXYZ point = RandomPoint(random, camera);
    const EdgeBal edge{random.Vec2(300.0)};
    const Vector3 P = InCamera(camera, point);
    const double px = -P[0] / P[2], py = -P[1] / P[2], n = px * px + py * py;
    const double scale = camera.data[6] * (1.0 + camera.data[7] * n + camera.data[8] * n * n);
    Vector2 r;
    ASSERT_TRUE(edge.Evaluate(camera, point, r, nullptr, nullptr));
    EXPECT_LT((r - Vector2(scale * px - edge.uv[0], scale * py - edge.uv[1])).norm(), 1e-10);
    EXPECT_NEAR(edge.Depth(camera, point), -P[2], 1e-13);
    if (P[2] > 0.0) ++behind;
  }
  EXPECT_GT(behind, 5);
}

TEST(EdgeBal, Jacobians) {
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const VertexCameraBal camera = RandomCamera(random, random.Uniform(0.0, 3.1));
    ExpectJacobians(EdgeBal{random.Vec2(300.0)}, camera, RandomPoint(random, camera));
  }
  for (const double angle : test::kSpecialAngles) {
    SCOPED_TRACE(angle);
    const VertexCameraBal camera = RandomCamera(random, angle);
    ExpectJacobians(EdgeBal{random.Vec2(300.0)}, camera, RandomPoint(random, camera));
  }
  for (const double angle :
       {3.1415926535897931, 4.0, 7.0}) {  // BAL rotation vectors are not reduced
    SCOPED_TRACE(angle);
    const VertexCameraBal camera = RandomCamera(random, angle);
    ExpectJacobians(EdgeBal{random.Vec2(300.0)}, camera, RandomPoint(random, camera));
  }
}

TEST(EdgeBal, NoValueInTheCameraPlane) {
  VertexCameraBal camera;
  camera.data[6] = 500.0;
  Vector2 r;
  EXPECT_FALSE(EdgeBal{}.Evaluate(camera, VertexPointXYZ(1.0, 2.0, 0.0), r, nullptr, nullptr));
  camera.data[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(EdgeBal{}.Evaluate(camera, VertexPointXYZ(1.0, 2.0, 3.0), r, nullptr, nullptr));
}

}  // namespace
}  // namespace glissade
