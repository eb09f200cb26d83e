// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "glissade/problem/problem.h"
#include "glissade/sim/vi_problem.h"
#include "glissade/sim/vi_window.h"

namespace glissade::app {

struct WalkOptions {
  int window = 7;  ///< keyframes that stay
  FirstEstimates mode = FirstEstimates::kFull;
  /// The oldest keyframe's position and yaw are held where they are; else nothing is.
  bool fixed_gauge = false;
  SolveOptions solve;
  sim::ViWindowOptions front_end;
};

/// One keyframe's turn: it came, the window was solved, the oldest went.
struct WalkFrame {
  int keyframe = 0;
  double cost = 0.0;
  int iterations = 0, rejected = 0;
  double solve_ms = 0.0;
  int removed_points = 0;  ///< that were behind a camera
  /// How far the oldest keyframe has turned about the vertical since a prior touched it first
  /// (rad).
  double yaw_since_linearized = 0.0;
  // After the marginalization. Position: the worst of three axes.
  double kappa_yaw = 0.0, kappa_position = 0.0;
  double yaw_information = 0.0;  ///< 1/rad^2
  /// The newest keyframe as seen from the oldest: squared error over its claimed covariance, by
  /// degrees of freedom (1 and 3). An honest window has 1 on average.
  double nees_yaw = 0.0, nees_position = 0.0;
  /// Of the way from the first keyframe, put together from what each knew of the next when it left.
  double drift_m = 0.0;
};

/// A window slides over the measurements. Ends early after an interrupt.
Result<std::vector<WalkFrame>> WalkWindow(const sim::ViProblem& data, const WalkOptions& options);

}  // namespace glissade::app
