// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A window that stands still for long: nothing drifts, and nothing grows. GLISSADE_STANDING_SECONDS
// makes it longer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "common/random_states.h"
#include "glissade/glissade.h"
#include "glissade/sim/noise_source.h"
#include "glissade/window/sliding_window.h"
#include "window/standing_imu.h"

namespace glissade {
namespace {

/// Stands before a wall of points that two cameras see, 10 times a second.
struct Standing {
  ImuNoise noise{.gyro_noise_density = 1.7e-4,
                 .accel_noise_density = 2.0e-3,
                 .gyro_random_walk = 2.0e-5,
                 .accel_random_walk = 3.0e-3};
  std::vector<WindowCamera> cameras;
  std::vector<Vector3> points;  // in the body
  test::StandingImu imu;

  explicit Standing(double seconds) {
    // Looking along the body's x axis: z forward, x right, y down.
    Matrix3 R_b_c;
    R_b_c << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    for (const double y : {0.05, -0.05}) {
      WindowCamera camera;
      camera.fx = camera.fy = 450.0;
      camera.cx = 376.0;
      camera.cy = 240.0;
      camera.T_b_c = Pose(R_b_c, Vector3(0.0, y, 0.0));
      cameras.push_back(camera);
    }
    test::Random random(5);
    for (int i = 0; i < 60; ++i) {
      points.emplace_back(random.Uniform(2.0, 6.0), random.Uniform(-1.2, 1.2),
                          random.Uniform(-0.8, 0.8));
    }
    imu.R_w_b = so3::Exp(Vector3(0.1, -0.05, 0.0));
    imu.bias.ba = Vector3(0.05, -0.08, 0.06);
    imu.bias.bg = Vector3(0.004, -0.003, 0.002);
    imu.seconds = seconds;
  }

  [[nodiscard]] std::vector<FrameObservation> See(sim::NoiseSource& noise_source) const {
    std::vector<FrameObservation> observations;
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t c = 0; c < cameras.size(); ++c) {
        const Vector3 x = cameras[c].T_b_c.Inverse() * points[i];
        const Vector3 n = noise_source.Normal3(1.0);
        observations.push_back({static_cast<std::int64_t>(i), static_cast<int>(c),
                                cameras[c].fx * x[0] / x[2] + cameras[c].cx + n[0],
                                cameras[c].fy * x[1] / x[2] + cameras[c].cy + n[1]});
      }
    }
    return observations;
  }
};

TEST(StandingStill, BeginsByItselfAndDoesNotDrift) {
  const char* asked = std::getenv("GLISSADE_STANDING_SECONDS");
  const double seconds = asked != nullptr ? std::max(30.0, std::atof(asked)) : 30.0;
  const Standing scene(seconds);
  SlidingWindowOptions options;
  options.cameras = scene.cameras;
  options.imu_noise = scene.noise;
  SlidingWindow window(options);
  const std::vector<ImuSample> samples = scene.imu.Read(scene.noise);
  sim::NoiseSource pixels(3, 1);

  std::size_t next = 0;
  double farthest = 0.0, turned = 0.0;
  std::size_t most_frames = 0, most_landmarks = 0;
  Pose first;
  bool running = false;
  for (int k = 0; k < static_cast<int>(10.0 * seconds); ++k) {
    const std::int64_t stamp = 1'000'000'000 + std::int64_t{100'000'000} * k;
    const std::size_t begin = next;
    while (next < samples.size() && samples[next].stamp_ns <= stamp)
      ++next;
    ASSERT_TRUE(window.AddImu(std::span(samples).subspan(begin, next - begin)).ok());
    const Status added = window.AddFrame(stamp, scene.See(pixels));
    ASSERT_TRUE(added.ok()) << added.message();
    const Status solved = window.Optimize();
    ASSERT_TRUE(solved.ok()) << solved.message();
    if (window.phase() != WindowPhase::kRunning) continue;
    if (!running) first = window.newest().T_w_b;
    running = true;
    const Pose moved = first.Inverse() * window.newest().T_w_b;
    farthest = std::max(farthest, moved.p().norm());
    turned = std::max(turned, so3::Log(Quaternion(moved.q())).norm());
    most_frames = std::max(most_frames, window.view().frames.size());
    most_landmarks = std::max(most_landmarks, window.view().landmarks.size());
  }
  ASSERT_TRUE(running) << window.init_verdict().message;
  EXPECT_GT(window.total_events()[WindowEvent::kStandingStill], 250);
  if (asked != nullptr) {
    std::printf("%.0f s: %.2f mm, %.3f deg at most from where it began\n", seconds, 1e3 * farthest,
                turned * 180.0 / 3.14159265);
  }
  EXPECT_LT(farthest, 0.01);
  // Whatever the bias of the accelerometer does meanwhile.
  EXPECT_LT(turned * 180.0 / 3.14159265, 0.1);
  EXPECT_LE(most_frames, 10u);
  EXPECT_LE(most_landmarks, 60u);
  // As OKVIS's strategy would have it, but no keyframes of a scene that does not change.
  EXPECT_LE(window.total_events()[WindowEvent::kKeyframe], 3);
}

}  // namespace
}  // namespace glissade
