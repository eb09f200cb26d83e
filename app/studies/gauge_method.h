// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/problem/problem.h"
#include "glissade/sim/evaluation.h"
#include "glissade/sim/vi_problem.h"

/// \file
/// One visual-inertial problem solved in one gauge: the unit of the gauge study (Zhang, Gallego,
/// Scaramuzza, RA-L 2018).
namespace glissade::app {

enum class GaugeMethod { kFixed, kFree, kPrior };
inline constexpr GaugeMethod kGaugeMethods[] = {GaugeMethod::kFixed, GaugeMethod::kFree,
                                                GaugeMethod::kPrior};
const char* ToString(GaugeMethod method);

/// The gauge on the first keyframe, its reference the start. A weight of 0 is no prior: free.
Gauge MakeGauge(GaugeMethod method, double weight, const sim::ViProblem& problem,
                const sim::ViHandles& handles);

/// The rules of Ceres' Levenberg-Marquardt, which the paper used: relative decrease of the cost
/// under 1e-6, lambda_0 = 1e-4, one thread.
SolveOptions PaperOptions();
/// Until the state does not change any more. A light prior makes a valley so flat that what is left
/// to gain is below the rounding of the cost: a second solve, `polish`, then goes on almost without
/// damping.
SolveOptions ConvergedOptions(bool polish = false);

/// One state on the way of a solve.
struct GaugeStep {
  int iteration = 0;             ///< linear solves so far
  double reprojection_px = 0.0;  ///< mean over the observations
  double prior_position_m = 0.0;
  double prior_yaw_rad = 0.0;
};

struct GaugeRun {
  sim::ViErrors errors;
  int iterations = 0;  ///< linear solves
  double time_ms = 0.0;
  double cost = 0.0;  ///< without the prior
  bool converged = false;
  sim::ViStates states;
  std::vector<GaugeStep> steps;
};

struct GaugeRunOptions {
  SolveOptions solve = PaperOptions();
  int timed_runs = 1;         ///< the fastest counts; results are the same
  bool record_steps = false;  ///< in a run that is not timed
  bool converge = false;      ///< ConvergedOptions in place of `solve`, but its linear solver
};

Result<GaugeRun> RunGauge(const sim::ViProblem& problem, GaugeMethod method, double weight,
                          const GaugeRunOptions& options);

/// Where the states would be with the first keyframe in the fixed gauge of the problem's start.
sim::ViStates MovedToStart(const sim::ViStates& states, const sim::ViProblem& problem);

}  // namespace glissade::app
