// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/base/status.h"
#include "glissade/io/viowin.h"
#include "glissade/sim/vi_world.h"

namespace glissade::sim {

/// A sliding window as an estimator would have it before a solve.
struct WindowMakerOptions {
  int num_keyframes = 10;
  double interval_s = 0.25;          ///< between keyframes
  int landmarks_per_keyframe = 25;   ///< on the average
  int min_track = 4, max_track = 8;  ///< keyframes that see a landmark, its host included
  /// At least so many landmarks have the first keyframe as host: for marginalizing it.
  int hosted_by_first = 0;
  /// The flight (its length follows from speed, interval and number), camera, IMU, noise, and how
  /// far the start of poses and velocities is off.
  ViWorldOptions world = DefaultWorld();
  double start_log_depth = 0.2;    ///< sigma of log(rho / rho_true) at the start
  double start_accel_bias = 0.02;  ///< sigma (m/s^2)
  double start_gyro_bias = 0.002;  ///< sigma (rad/s)

  /// Sine at 1.5 m/s past points 2.5 to 15 m away, one pixel of noise, a good MAV's IMU.
  static ViWorldOptions DefaultWorld();
  [[nodiscard]] Status Validate() const;
};

/// A window with a tight prior on the first pose (both problems), a loose one on the last (vision
/// only: it holds the scale) and one on the first speed and biases. Pixels are rounded to 1/256.
/// The same numbers for the same seed. kInvalidArgument where the options make no sense.
[[nodiscard]] Result<ViowinWindow> MakeWindow(const WindowMakerOptions& options,
                                              std::uint64_t seed);

}  // namespace glissade::sim
