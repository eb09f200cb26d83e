// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/camera.h"

#include <gtest/gtest.h>

namespace glissade::vision {
namespace {

TEST(VisionCamera, UndistortsWhatItDistorts) {
  Camera camera;
  camera.width = 752;
  camera.height = 480;
  const CameraPinhole pinhole{458.0, 457.0, 367.0, 248.0};
  const decltype(Camera::lens) lenses[] = {
      pinhole, CameraRadtan{pinhole, -0.283, 0.074, 2e-4, 1.8e-5, 0.0},
      CameraKannalaBrandt{pinhole, 0.0035, 0.0007, -0.0020, 0.0002}};
  for (const auto& lens : lenses) {
    camera.lens = lens;
    ASSERT_TRUE(camera.Validate().ok());
    EXPECT_EQ(camera.pinhole(), pinhole);
    for (double v = 0.0; v < 480.0; v += 37.0) {
      for (double u = 0.0; u < 752.0; u += 41.0) {
        const double uv[2] = {u, v};
        double xy[2], back[2];
        ASSERT_TRUE(camera.Undistort(uv, xy)) << u << " " << v;
        ASSERT_TRUE(camera.Distort(xy, back));
        EXPECT_NEAR(back[0], u, 1e-9);
        EXPECT_NEAR(back[1], v, 1e-9);
      }
    }
  }
}

TEST(VisionCamera, WithoutDistortionIsWhatAWindowTakes) {
  Camera camera;
  camera.lens = CameraRadtan{{458.0, 457.0, 367.0, 248.0}, -0.283, 0.074, 0.0, 0.0, 0.0};
  camera.T_b_c.p() = Vector3(0.1, 0.2, 0.3);
  const WindowCamera window = WithoutDistortion(camera, 0.7);
  EXPECT_TRUE(window.Validate().ok());
  EXPECT_EQ(window.fx, 458.0);
  EXPECT_EQ(window.cy, 248.0);
  EXPECT_EQ(window.sigma_px, 0.7);
  EXPECT_EQ(window.T_b_c, camera.T_b_c);
}

TEST(VisionCamera, RefusesWhatIsNone) {
  Camera camera;
  EXPECT_EQ(camera.Validate().code(), StatusCode::kNotPositive);  // no size
  camera.width = camera.height = 100;
  EXPECT_TRUE(camera.Validate().ok());
  camera.lens = CameraPinhole{-1.0, 1.0, 0.0, 0.0};
  EXPECT_FALSE(camera.Validate().ok());
  camera.lens = CameraPinhole{};
  camera.T_b_c.data[3] = 2.0;
  EXPECT_FALSE(camera.Validate().ok());
}

}  // namespace
}  // namespace glissade::vision
