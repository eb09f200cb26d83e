// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "common/random_states.h"
#include "glissade/cameras/identity.h"
#include "glissade/cameras/kannala_brandt.h"
#include "glissade/cameras/pinhole.h"
#include "glissade/cameras/radtan.h"
#include "glissade/testing/numeric_derivative.h"

namespace glissade {
namespace {

using test::Random;
constexpr double kPi = std::numbers::pi;

// EuRoC's cam0, and a typical fisheye (TUM-VI's cam0).
const CameraPinhole kPinhole{458.654, 457.296, 367.215, 248.375};
const CameraRadtan kRadtan{kPinhole, -0.28340811, 0.07395907, 0.00019359, 1.76187114e-05};
const CameraRadtan kRadtan3{kPinhole, -0.3, 0.1, 0.002, -0.003, -0.01};
const CameraKannalaBrandt kFisheye{
    {190.9785, 190.9733, 254.9317, 256.8974}, 0.0034824, 0.0007150, -0.0020532, 0.0002029};

/// d_uv_d_p against numeric derivatives; d_xy_d_uv likewise where there is a ray.
template <class Camera>
void ExpectProjectJacobian(const Camera& camera, const Vector3& p) {
  Vector2 uv, uv_alone;
  Matrix<2, 3> J;
  ASSERT_TRUE(camera.Project(p, uv, &J));
  ASSERT_TRUE(camera.Project(p, uv_alone, nullptr));
  EXPECT_LE((uv - uv_alone).norm(), 1e-12 * uv.norm());
  for (int column = 0; column < 3; ++column) {
    const NumericDerivative numeric = Differentiate(
        [&](double t, double* y) {
          Vector3 moved = p;
          moved[column] += t;
          Vector2 at;
          if (!camera.Project(moved, at, nullptr)) return false;
          y[0] = at[0];
          y[1] = at[1];
          return true;
        },
        2, 1e-2 * p.norm());
    EXPECT_LT((J.col(column) - Vector2(numeric.value[0], numeric.value[1])).norm(), 1e-8 * J.norm())
        << p.transpose();
  }
}

template <class Camera>
void ExpectUnprojectInverts(const Camera& camera, const Vector2& xy) {
  Vector2 uv, back;
  Matrix<2, 3> d_uv_d_p;
  Matrix2 d_xy_d_uv;
  ASSERT_TRUE(camera.Project(Vector3(xy[0], xy[1], 1.0), uv, &d_uv_d_p));
  ASSERT_TRUE(camera.Unproject(uv, back, &d_xy_d_uv)) << xy.transpose();
  EXPECT_LT((back - xy).norm(), 1e-12 * (1.0 + xy.squaredNorm())) << xy.transpose();
  // Inverse functions have inverse derivatives.
  const Matrix2 product = d_xy_d_uv * d_uv_d_p.leftCols<2>();
  EXPECT_LT((product - Matrix2::Identity()).norm(), 1e-9 * (1.0 + xy.squaredNorm()));
}

template <class Camera>
void CheckCamera(const Camera& camera, double largest_xy) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const double z = random.Uniform(0.2, 20.0);
    const Vector2 xy = random.Vec2(largest_xy);
    ExpectProjectJacobian(camera, z * Vector3(xy[0], xy[1], 1.0));
    ExpectUnprojectInverts(camera, xy);
  }
  for (const double small : {0.0, 1e-160, 1e-9, 1e-6, 0.9e-5, 1.1e-5, 1e-4, 1e-3}) {
    ExpectProjectJacobian(camera, 3.0 * Vector3(small, 0.5 * small, 1.0));
    ExpectUnprojectInverts(camera, Vector2(small, -0.3 * small));
  }
  Vector2 uv;
  EXPECT_FALSE(camera.Project(Vector3::Zero(), uv, nullptr));
}

TEST(Cameras, ProjectAndUnproject) {
  CheckCamera(CameraIdentity{}, 3.0);
  CheckCamera(kPinhole, 3.0);
  CheckCamera(kRadtan, 0.6);
  CheckCamera(kRadtan3, 0.5);
  CheckCamera(kFisheye, 8.0);
}

TEST(CameraPinhole, Formula) {
  Vector2 uv;
  ASSERT_TRUE(kPinhole.Project(Vector3(1.0, 2.0, 4.0), uv, nullptr));
  EXPECT_DOUBLE_EQ(uv[0], 458.654 * 0.25 + 367.215);
  EXPECT_DOUBLE_EQ(uv[1], 457.296 * 0.5 + 248.375);
  ASSERT_TRUE(kPinhole.Project(Vector3(-1.0, -2.0, -4.0), uv, nullptr));  // behind: evaluated
  EXPECT_DOUBLE_EQ(uv[0], 458.654 * 0.25 + 367.215);
  EXPECT_FALSE(kPinhole.Project(Vector3(1.0, 2.0, 0.0), uv, nullptr));
}

TEST(CameraRadtan, Formula) {
  const double x = 0.3, y = -0.2, r2 = x * x + y * y;
  const CameraRadtan& c = kRadtan3;
  const double radial = 1 + c.k1 * r2 + c.k2 * r2 * r2 + c.k3 * r2 * r2 * r2;
  Vector2 uv;
  ASSERT_TRUE(c.Project(2.0 * Vector3(x, y, 1.0), uv, nullptr));
  EXPECT_NEAR(
      uv[0],
      c.pinhole.fx * (x * radial + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x)) + c.pinhole.cx,
      1e-11);
  EXPECT_NEAR(
      uv[1],
      c.pinhole.fy * (y * radial + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y) + c.pinhole.cy,
      1e-11);
}

TEST(CameraRadtan, NoRayWhereTheDistortionTurnsBack) {
  // r (1 - 0.3 r^2) grows up to r = 1.054, to 0.703 at most.
  const CameraRadtan camera{{1.0, 1.0, 0.0, 0.0}, -0.3};
  Vector2 xy;
  EXPECT_TRUE(camera.Unproject(Vector2(0.70, 0.0), xy, nullptr));
  EXPECT_LT(xy[0], 1.0541);
  EXPECT_FALSE(camera.Unproject(Vector2(0.71, 0.0), xy, nullptr));
  EXPECT_FALSE(camera.Unproject(Vector2(5.0, 0.0), xy, nullptr));
  EXPECT_FALSE(
      camera.Unproject(Vector2(std::numeric_limits<double>::quiet_NaN(), 0.0), xy, nullptr));
}

TEST(CameraKannalaBrandt, Formula) {
  const CameraKannalaBrandt& c = kFisheye;
  for (const double theta : {0.2, 1.0, 1.5, 1.7, 3.0}) {  // the last two behind the image plane
    const double phi = 0.7, t2 = theta * theta;
    const double theta_d =
        theta * (1 + c.k1 * t2 + c.k2 * t2 * t2 + c.k3 * t2 * t2 * t2 + c.k4 * t2 * t2 * t2 * t2);
    const Vector3 p = 2.5 * Vector3(std::sin(theta) * std::cos(phi),
                                    std::sin(theta) * std::sin(phi), std::cos(theta));
    Vector2 uv;
    ASSERT_TRUE(c.Project(p, uv, nullptr));
    EXPECT_NEAR(uv[0], c.pinhole.fx * theta_d * std::cos(phi) + c.pinhole.cx, 1e-10);
    EXPECT_NEAR(uv[1], c.pinhole.fy * theta_d * std::sin(phi) + c.pinhole.cy, 1e-10);
    ExpectProjectJacobian(c, p);
  }
}

TEST(CameraKannalaBrandt, NoRayAtNinetyDegreesAndBeyond) {
  const CameraKannalaBrandt camera{{100.0, 100.0, 0.0, 0.0}};
  Vector2 uv, xy;
  EXPECT_TRUE(camera.Unproject(Vector2(100.0 * (kPi / 2 - 1e-3), 0.0), xy, nullptr));
  EXPECT_NEAR(xy[0], 1e3, 1.0);
  EXPECT_FALSE(camera.Unproject(Vector2(100.0 * kPi / 2, 0.0), xy, nullptr));
  EXPECT_FALSE(
      camera.Unproject(Vector2(std::numeric_limits<double>::quiet_NaN(), 0.0), xy, nullptr));
  EXPECT_FALSE(camera.Project(Vector3(0.0, 0.0, -1.0), uv, nullptr));
  // theta (1 - 0.3 theta^2) turns back at 60 degrees.
  const CameraKannalaBrandt strong{{100.0, 100.0, 0.0, 0.0}, -0.3};
  EXPECT_TRUE(strong.Unproject(Vector2(70.0, 0.0), xy, nullptr));
  EXPECT_FALSE(strong.Unproject(Vector2(71.0, 0.0), xy, nullptr));
}

TEST(Cameras, Validate) {
  EXPECT_TRUE(kRadtan.Validate().ok());
  EXPECT_TRUE(kFisheye.Validate().ok());
  CameraPinhole bad = kPinhole;
  bad.fx = 0.0;
  EXPECT_EQ(bad.Validate().code(), StatusCode::kNotPositive);
  EXPECT_EQ((CameraRadtan{bad}.Validate().code()), StatusCode::kNotPositive);
  CameraKannalaBrandt nan = kFisheye;
  nan.k3 = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(nan.Validate().code(), StatusCode::kNotFinite);
  EXPECT_TRUE(ValidateCamera(CameraIdentity{}).ok());
}

}  // namespace
}  // namespace glissade
