// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/graph/first_estimates.h"
#include "glissade/imu/buffer.h"
#include "glissade/imu/noise.h"
#include "glissade/losses/loss.h"
#include "glissade/window/init_verdict.h"
#include "glissade/window/observation.h"
#include "glissade/window/stillness.h"
#include "glissade/window/triangulate.h"

namespace glissade {

class WindowPolicy;

/// When a frame is kept for longer than the newest ones. Any of the rules is enough; without an IMU
/// every frame is a keyframe, and while the body stands still none is.
struct KeyframeRules {
  /// Less than this part of the last keyframe's landmarks is seen.
  double min_tracked_share = 0.6;
  /// Tracks have moved by more than this since the last keyframe, in the mean, in normalized
  /// coordinates (rad, for small angles), rotation taken out where an IMU knows it.
  double max_parallax = 0.05;
  double max_interval_s = 2.0;
};

/// How well a first state is known: standard deviations, each coordinate. Position and heading are
/// those of the world by definition.
struct InitialSigmas {
  double tilt = 0.1;        ///< rad
  double speed = 0.1;       ///< m/s
  double accel_bias = 0.1;  ///< m/s^2
  double gyro_bias = 0.01;  ///< rad/s

  [[nodiscard]] Status Validate() const;
};

/// What SlidingWindow is told once.
struct SlidingWindowOptions {
  std::vector<WindowCamera> cameras;
  /// Absent: no IMU, and states without speed and biases. Needs two cameras then.
  std::optional<ImuNoise> imu_noise;
  /// Ranges of the sensors: readings at their ends are trusted less.
  ImuBufferOptions imu;
  /// m/s^2. The world's z axis points up, whatever the recording's own world does.
  double gravity = 9.81;

  /// Which frames stay; null: OkvisPolicy with its defaults.
  std::shared_ptr<WindowPolicy> policy;
  KeyframeRules keyframes;
  FirstEstimates first_estimates = FirstEstimates::kFull;

  /// Of observations.
  Loss loss;
  /// r'r in sigmas beyond which an observation is taken out after a solve: 99.9 % of chi2, 2 DoF.
  double max_chi2 = 13.8;
  /// Length of r in sigmas beyond which an observation of a known landmark is left out before a
  /// solve, where the IMU has predicted the frame: without a gap, and not alone for more than a
  /// second. Far beyond what a prediction is off by, for what is no view of the landmark at all.
  double max_prediction_error = 60.0;
  TriangulationOptions triangulation;
  /// A solve has converged where the cost falls by less than this part of itself.
  double cost_tolerance = 1e-4;
  /// A landmark with fewer observations than this in the window says nothing and is taken out.
  int min_observations = 2;

  /// What is known of the biases before anything is measured.
  ImuBiasPrior bias_prior;
  /// What standing still means: where a window may begin, and what it adds while it lasts.
  StillnessOptions stillness;
  /// Whether standing still is made use of once the window runs.
  bool use_stillness = true;

  /// A frame or an IMU sample whose stamp is further than this from the last one is refused: a
  /// stamp that is wrong. Where the clock stays there (3 frames, 10 samples in a row) it was set,
  /// and the window begins anew by its time.
  std::int64_t max_frame_gap_ns = 10'000'000'000;
  /// A state that is faster (m/s), or has a bias further from its prior than so many sigmas of it,
  /// is no state: the window begins anew.
  double max_speed = 100.0;
  double max_bias_sigmas = 10.0;
  /// So many solves that fail in a row make the window begin anew.
  int max_failed_solves = 3;

  SlidingWindowOptions();
  [[nodiscard]] Status Validate() const;
};

/// How much one Optimize() may do.
struct WindowBudget {
  int max_iterations = 4;  ///< linear solves
  double max_time_s = std::numeric_limits<double>::infinity();
};

}  // namespace glissade
