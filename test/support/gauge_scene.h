// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/problem/problem.h"

/// \file
/// Scenes that no absolute measurement ties down: what gauges are for.
namespace glissade::test {

struct GaugeSceneOptions {
  int num_frames = 10;
  int num_points = 80;
  int views = 5;  ///< frames that a point is seen in, at most
  bool imu = true;
  /// Biases are states; else they are known, and held (Fix::kBiases).
  bool biases = true;
  /// Inverse depths hosted by the first frame that sees them; else XYZ points.
  bool inverse_depth = true;
  /// Relative poses between neighbours instead of IMU terms: the scale is then observed.
  bool relative_poses = false;
  /// Of measurements, in their sigmas. Zero: the true states are the optimum.
  double noise = 1.0;
  /// Standard deviation of the start's rotations [rad]; positions and velocities have ten times it.
  double start_noise = 0.01;
  bool lever = true;  ///< the camera is not at the body's origin
};

struct GaugeScene {
  Problem problem;
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<VertexHandle<VertexSpeedBias>> speeds;
  std::vector<AnyVertex> points;
  Pose T_b_c;

  explicit GaugeScene(std::uint64_t seed, const GaugeSceneOptions& options = {});
  /// All vertices that are not fixed, in the graph's order.
  [[nodiscard]] std::vector<AnyVertex> All() const { return problem.Vertices(); }
};

/// To the last digit that the cost has.
SolveOptions Converge(const Gauge& gauge = {});

/// Rotation about world z that takes `from` to `now`: z part of Log(R R0').
double YawBetween(const Pose& from, const Pose& now);

}  // namespace glissade::test
