// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "glissade/problem/problem.h"
#include "glissade/sim/course_scene.h"

namespace glissade::app {

/// One state on the way of a solve. Prior errors are measured to the poses that priors are on (for
/// weight 0: would be on), so that runs with and without them can be compared.
struct SweepStep {
  int iteration = 0;                  ///< linear solves so far
  double cost = 0.0;                  ///< 1/2 sum of squares
  double reprojection_error = 0.0;    ///< RMS over observations, normalized image plane
  double prior_position_error = 0.0;  ///< RMS over prior poses (m)
  double prior_rotation_error = 0.0;  ///< RMS over prior poses (rad)
};

struct SweepTrial {
  CourseErrors errors;
  int iterations = 0;  ///< linear solves
  double time_s = 0.0;
  Termination termination = Termination::kFailed;
  bool converged = false;
  std::vector<SweepStep> steps;
};

struct SweepRow {
  bool fixed = false;   ///< the first two poses held: what priors tend to
  double weight = 0.0;  ///< of the prior; 0: none, errors after similarity alignment
  std::vector<SweepTrial> trials;
};

struct SweepOptions {
  std::vector<double> weights;
  double pose_noise = 0.0;  ///< sigma of the start poses, per axis (m, rad)
  int trials = 1;
  std::uint32_t seed = 1;
  SolveOptions solve;
  int num_priors = 2;
};

/// Solves the scene for each weight and trial, and once more with the first poses fixed. The start
/// poses of a trial are the same for all weights; priors stay at the truth. Interrupted, it returns
/// the rows and trials until then.
Result<std::vector<SweepRow>> RunSweep(const CourseScene& scene, const SweepOptions& options);

}  // namespace glissade::app
