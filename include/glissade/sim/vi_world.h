// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

#include "glissade/base/status.h"
#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"
#include "glissade/sim/trajectory.h"
#include "glissade/sim/vi_problem.h"

namespace glissade::sim {

enum class PointLayout {
  kPlane,   ///< on walls, floor and ceiling of a room around the flight
  kRandom,  ///< along the flight, at all depths
};

/// "plane", "random".
std::string_view ToString(PointLayout layout);

/// Everything a visual-inertial world is made of. The study that these worlds are for (Zhang,
/// Gallego, Scaramuzza, RA-L 2018) leaves most of it open; docs/gauge_study.md lists the defaults.
struct ViWorldOptions {
  TrajectoryKind trajectory = TrajectoryKind::kSine;
  PointLayout points = PointLayout::kPlane;
  double length_m = 5.0;
  int laps = 1;  ///< of that length each, one after the other
  double speed_mps = 2.0;
  int num_keyframes = 10;  ///< evenly over the flight
  int num_points = 50;
  int min_observations = 3;  ///< of a point: others are drawn again

  double wall_distance_m = 4.0;     ///< kPlane: from the box around the flight
  double floor_distance_m = 2.0;    ///< kPlane: floor and ceiling
  double plane_roughness_m = 0.05;  ///< kPlane: sigma of a point across its plane
  double min_depth_m = 2.0;         ///< kRandom, in the camera the point is drawn in
  double max_depth_m = 8.0;         ///< kRandom
  double nearest_visible_m = 0.5;   ///< a camera sees from this depth on

  ViCamera camera = DefaultCamera();
  double pixel_noise = 2.0;  ///< sigma that is drawn (px); camera.sigma_px is what is assumed

  double imu_rate_hz = 200.0;
  ImuNoise imu_noise = DefaultNoise();
  double accel_bias_sigma = 0.1;  ///< of the biases at the start, which are drawn (m/s^2)
  double gyro_bias_sigma = 0.01;  ///< rad/s
  Vector3 gravity = Vector3(0.0, 0.0, -9.81);

  // Where a solve begins.
  double start_position_m = 0.05;    ///< length of a random vector
  double start_rotation_deg = 6.0;   ///< angle about a random axis
  double start_velocity_mps = 0.05;  ///< uniform on either side, each axis
  double start_point_m = 0.075;      ///< uniform on either side, each axis
  bool perturb_first = true;         ///< the first keyframe too

  std::uint64_t seed = 1;  ///< of points and biases

  /// A consumer's IMU, ten times that of a good MAV's.
  static ImuNoise DefaultNoise() {
    return {.gyro_noise_density = 1.0e-3,
            .accel_noise_density = 2.0e-2,
            .gyro_random_walk = 2.0e-5,
            .accel_random_walk = 3.0e-3};
  }
  /// On the body's nose, looking forward.
  static ViCamera DefaultCamera();
  [[nodiscard]] Status Validate() const;
};

/// The truth: keyframes, points, and who sees what. Measurements are drawn with Measure().
struct ViWorld {
  ViWorldOptions options;
  Trajectory trajectory;
  ViProblem exact;                     ///< without noise; start = truth; no IMU terms yet
  std::vector<ImuSample> imu_samples;  ///< without noise and biases
};

/// kInvalidArgument where the options make no sense, or too few points can be seen often enough.
[[nodiscard]] Result<ViWorld> MakeViWorld(const ViWorldOptions& options);

/// Draws pixel noise, IMU noise and biases (random walk included) and a start, each from its own
/// stream of `seed`. The truth's biases are those drawn; the start has them too: for estimators
/// they are known.
[[nodiscard]] Result<ViProblem> Measure(const ViWorld& world, std::uint64_t seed);

}  // namespace glissade::sim
