// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "glissade/sim/vi_world.h"
#include "studies/gauge_method.h"
#include "studies/parallel_trials.h"

/// \file
/// The experiments of the gauge study. Trials run side by side, each on one thread; results do not
/// depend on how many.
namespace glissade::app {

struct GaugeStudyOptions {
  int trials = 50;
  std::uint32_t seed = 1;
  int num_threads = 2;
  int timed_runs = 3;
  LinearSolverType linear_solver = LinearSolverType::kAuto;
  int converged_trials = 5;     ///< of these, solves are also run until they converge
  double prior_weight = 1e5;    ///< of the method "prior"
  std::vector<double> weights;  ///< of the sweep
  std::vector<double> path_weights;
};

/// lambda_0 that leaves the gauge to the prior, instead of holding it as the paper's 1e-4 does.
inline constexpr double kLightDamping = 1e-9;

/// A method, or a weight, over all trials.
struct GaugeSamples {
  std::vector<double> position_m, rotation_deg, velocity_mps, iterations, time_ms, cost;
  void Resize(std::size_t n);
  void Set(std::size_t trial, const GaugeRun& run);
};

/// How far from the fixed gauge's result a solve run to convergence ends.
struct GaugeAgreement {
  double cost = 0.0;  ///< relative, largest of the trials
  sim::ViDifference states;
  int iterations = 0;  ///< most
  bool converged = true;
  void Include(const GaugeRun& run, const GaugeRun& fixed, const sim::ViProblem& problem,
               bool aligned);
  /// The worse of both, in each.
  void Include(const GaugeAgreement& other);
};

struct GaugeConfiguration {
  std::string trajectory, points;  ///< or dataset and nothing
  GaugeSamples methods[3];         ///< in the order of kGaugeMethods
  GaugeAgreement free, prior;      ///< with fixed, converged
};

struct GaugeWeight {
  double weight = 0.0;
  GaugeSamples samples;
  GaugeSamples light;  ///< the same with kLightDamping at the start
  GaugeAgreement agreement;
};

struct GaugePath {
  double weight = 0.0;
  std::vector<GaugeStep> steps;
};

/// The problem of a trial.
using ProblemSource = std::function<Result<sim::ViProblem>(int trial)>;

/// All methods on the trials' problems.
Result<GaugeConfiguration> RunConfiguration(const ProblemSource& source,
                                            const GaugeStudyOptions& options,
                                            ProgressBar* progress);
Result<std::vector<GaugeWeight>> RunWeights(const ProblemSource& source,
                                            const GaugeStudyOptions& options,
                                            ProgressBar* progress);
/// The way of the first trial's problem.
Result<std::vector<GaugePath>> RunPaths(const ProblemSource& source,
                                        const GaugeStudyOptions& options);

/// Trials of a world: measurements and start are drawn anew, the world stays.
ProblemSource Simulated(sim::ViWorld world, std::uint64_t seed);

double Mean(const std::vector<double>& x);

}  // namespace glissade::app
