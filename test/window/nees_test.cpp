// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Consistency of a window: the newest state is as wrong as its covariance says, in the gauge in
// which position and yaw of the window's oldest frame are certain. Twelve flights;
// GLISSADE_NEES_RUNS asks for more, and tightens the bounds.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "common/sanitized.h"
#include "glissade/eval/alignment.h"
#include "glissade/eval/nees.h"
#include "glissade/io/replay.h"
#include "glissade/lie/so3.h"
#include "glissade/sim/noise_source.h"
#include "glissade/window/sliding_window.h"
#include "window/window_run.h"

namespace glissade {
namespace {

constexpr InitialSigmas kStart{.tilt = 0.01, .speed = 0.02, .accel_bias = 0.02, .gyro_bias = 0.002};

/// A start as wrong as kStart says.
WindowState Perturbed(const WindowState& truth, std::uint64_t seed) {
  sim::NoiseSource random(seed, 99);
  WindowState start = truth;
  start.T_w_b.q() = start.T_w_b.q() * so3::ExpQuaternion(random.Normal3(kStart.tilt));
  start.speed_bias.v() += random.Normal3(kStart.speed);
  start.speed_bias.ba() += random.Normal3(kStart.accel_bias);
  start.speed_bias.bg() += random.Normal3(kStart.gyro_bias);
  return start;
}

/// NEES of position and of rotation.
std::array<double, 2> NeesOfNewest(const Viotracks& flight, std::size_t frame,
                                   SlidingWindow* window) {
  std::array<double, 15 * 15> values{};
  EXPECT_TRUE(window->NewestCovariance(values).ok());
  const Eigen::Map<const Eigen::Matrix<double, 15, 15>> P(values.data());
  const WindowFrame& oldest = window->view().frames.front();
  std::size_t oldest_frame = 0;
  while (flight.frames[oldest_frame].stamp_ns != oldest.stamp_ns)
    ++oldest_frame;
  const eval::Alignment a =
      eval::AlignPose(oldest.T_w_b, test::TruthAt(flight, oldest_frame).T_w_b);
  const Pose aligned = a.T_r_e * window->newest().T_w_b;
  const Pose truth = test::TruthAt(flight, frame).T_w_b;
  const Matrix3 Rz = a.T_r_e.R();
  const Eigen::Vector3d p = aligned.p() - truth.p();
  const Eigen::Vector3d theta = so3::Log(Quaternion(truth.q().conjugate() * aligned.q()));
  const auto position = eval::Nees(p, Rz * P.topLeftCorner<3, 3>() * Rz.transpose());
  const auto rotation = eval::Nees(theta, P.block<3, 3>(3, 3));
  EXPECT_TRUE(position.ok() && rotation.ok());
  return {*position, *rotation};
}

TEST(WindowNees, TheNewestStateIsAsWrongAsItSays) {
  const char* asked = std::getenv("GLISSADE_NEES_RUNS");
  const int runs = asked != nullptr ? std::atoi(asked) : test::kSanitized ? 2 : 12;
  ASSERT_GT(runs, 0);
  std::array<double, 2> sum{};
  int count = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    const Viotracks flight = test::MakeFlight(static_cast<std::uint64_t>(seed));
    SlidingWindow window(test::OptionsFor(flight));
    ViotracksReplay replay(flight);
    while (replay.Next()) {
      ASSERT_TRUE(window.AddImu(replay.imu()).ok());
      if (window.phase() == WindowPhase::kInitializing) {
        const WindowState truth = test::TruthAt(flight, replay.frame());
        const auto stream = static_cast<std::uint64_t>(seed);
        ASSERT_TRUE(window.Start(Perturbed(truth, stream), kStart).ok());
        ASSERT_TRUE(window.Associate(replay.observations()).ok());
        ASSERT_TRUE(window.TriangulateTracks().ok());
        continue;
      }
      ASSERT_TRUE(window.AddFrame(replay.stamp_ns(), replay.observations()).ok());
      ASSERT_TRUE(window.Optimize().ok());
      if (replay.frame() % 20 != 10) continue;
      const auto nees = NeesOfNewest(flight, replay.frame(), &window);
      sum[0] += nees[0];
      sum[1] += nees[1];
      ++count;
    }
  }
  // Errors two seconds apart in one flight are not quite independent.
  const double sigma = std::sqrt(6.0 / (0.7 * count));
  RecordProperty("position", std::to_string(sum[0] / count));
  RecordProperty("rotation", std::to_string(sum[1] / count));
  EXPECT_NEAR(sum[0] / count, 3.0, 4.0 * sigma);
  EXPECT_NEAR(sum[1] / count, 3.0, 4.0 * sigma);
  if (asked != nullptr) {
    std::printf("NEES of %d states: position %.3f, rotation %.3f\n", count, sum[0] / count,
                sum[1] / count);
  }
}

}  // namespace
}  // namespace glissade
