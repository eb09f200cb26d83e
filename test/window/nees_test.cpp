// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Consistency of a window: the newest state is as wrong as its covariance says, in the gauge in
// which position and yaw of the window's oldest frame are certain. Twelve flights
// of twelve seconds; GLISSADE_NEES_RUNS and GLISSADE_NEES_LAPS ask for more, and for the other
// modes of first estimates beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
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

struct SumOfNees {
  std::array<double, 2> sum{};
  int count = 0;

  void Add(const std::array<double, 2>& nees) {
    sum[0] += nees[0];
    sum[1] += nees[1];
    ++count;
  }
  [[nodiscard]] double Mean(std::size_t i) const { return sum[i] / count; }
};

struct MeanNees {
  SumOfNees all;           ///< every two seconds
  SumOfNees first_second;  ///< every frame of it
};

MeanNees Fly(FirstEstimates first_estimates, int runs, int laps) {
  MeanNees mean;
  for (int seed = 1; seed <= runs; ++seed) {
    const Viotracks flight = test::MakeFlight(static_cast<std::uint64_t>(seed), laps);
    SlidingWindowOptions options = test::OptionsFor(flight);
    options.first_estimates = first_estimates;
    SlidingWindow window(options);
    ViotracksReplay replay(flight);
    while (replay.Next()) {
      EXPECT_TRUE(window.AddImu(replay.imu()).ok());
      if (window.phase() == WindowPhase::kInitializing) {
        const WindowState truth = test::TruthAt(flight, replay.frame());
        const auto stream = static_cast<std::uint64_t>(seed);
        EXPECT_TRUE(window.Start(Perturbed(truth, stream), kStart).ok());
        EXPECT_TRUE(window.Associate(replay.observations()).ok());
        EXPECT_TRUE(window.TriangulateTracks().ok());
        continue;
      }
      EXPECT_TRUE(window.AddFrame(replay.stamp_ns(), replay.observations()).ok());
      EXPECT_TRUE(window.Optimize().ok());
      const bool in_first_second = replay.frame() <= 10, sampled = replay.frame() % 20 == 10;
      if (!in_first_second && !sampled) continue;
      const auto nees = NeesOfNewest(flight, replay.frame(), &window);
      if (sampled) mean.all.Add(nees);
      if (in_first_second) mean.first_second.Add(nees);
    }
  }
  return mean;
}

int Asked(const char* name, int otherwise) {
  const char* asked = std::getenv(name);
  return asked != nullptr ? std::max(1, std::atoi(asked)) : otherwise;
}

TEST(WindowNees, TheNewestStateIsAsWrongAsItSays) {
  const bool asked = std::getenv("GLISSADE_NEES_RUNS") != nullptr;
  const int runs = Asked("GLISSADE_NEES_RUNS", test::kSanitized ? 2 : 12);
  const int laps = Asked("GLISSADE_NEES_LAPS", 1);
  const MeanNees mean = Fly(FirstEstimates::kFull, runs, laps);
  // Errors two seconds apart in one flight are not quite independent.
  const double sigma = std::sqrt(6.0 / (0.7 * mean.all.count));
  if (!asked) {
    EXPECT_NEAR(mean.all.Mean(0), 3.0, 4.0 * sigma);
    EXPECT_NEAR(mean.all.Mean(1), 3.0, 4.0 * sigma);
    return;
  }
  // The field's bounds for a hundred flights: a tenth on either side of what is expected.
  EXPECT_NEAR(mean.all.Mean(0), 3.0, 0.3);
  EXPECT_NEAR(mean.all.Mean(1), 3.0, 0.3);
  const auto print = [&](const char* mode, const MeanNees& m) {
    std::printf(
        "%d flights of %d s, %s: position %.3f, rotation %.3f (%d states); in the first "
        "second %.3f, %.3f\n",
        runs, 12 * laps, mode, m.all.Mean(0), m.all.Mean(1), m.all.count, m.first_second.Mean(0),
        m.first_second.Mean(1));
  };
  print("full", mean);
  print("prior", Fly(FirstEstimates::kPriorOnly, runs, laps));
  print("off", Fly(FirstEstimates::kOff, runs, laps));
}

}  // namespace
}  // namespace glissade
