// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/gauge_experiments.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace glissade::app {

namespace {

/// By the paper's rules, timed.
GaugeRunOptions Paper(const GaugeStudyOptions& study) {
  GaugeRunOptions options;
  options.solve.linear_solver_type = study.linear_solver;
  options.timed_runs = study.timed_runs;
  return options;
}

GaugeRunOptions Converge(const GaugeStudyOptions& study) {
  GaugeRunOptions options;
  options.solve.linear_solver_type = study.linear_solver;
  options.converge = true;
  return options;
}

std::size_t At(int k) {
  return static_cast<std::size_t>(k);
}

}  // namespace

double Mean(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x)
    sum += value;
  return x.empty() ? 0.0 : sum / static_cast<double>(x.size());
}

void GaugeSamples::Resize(std::size_t n) {
  for (auto* values : {&position_m, &rotation_deg, &velocity_mps, &iterations, &time_ms, &cost})
    values->resize(n);
}

void GaugeSamples::Set(std::size_t trial, const GaugeRun& run) {
  position_m[trial] = run.errors.position_m;
  rotation_deg[trial] = run.errors.rotation_deg;
  velocity_mps[trial] = run.errors.velocity_mps;
  iterations[trial] = run.iterations;
  time_ms[trial] = run.time_ms;
  cost[trial] = run.cost;
}

void GaugeAgreement::Include(const GaugeRun& run, const GaugeRun& fixed,
                             const sim::ViProblem& problem, bool aligned) {
  GaugeAgreement one;
  one.cost = std::abs(run.cost - fixed.cost) / fixed.cost;
  one.states =
      sim::Difference(aligned ? MovedToStart(run.states, problem) : run.states, fixed.states);
  one.iterations = run.iterations;
  one.converged = run.converged;
  Include(one);
}

void GaugeAgreement::Include(const GaugeAgreement& other) {
  cost = std::max(cost, other.cost);
  states.position_m = std::max(states.position_m, other.states.position_m);
  states.rotation_rad = std::max(states.rotation_rad, other.states.rotation_rad);
  states.velocity_mps = std::max(states.velocity_mps, other.states.velocity_mps);
  iterations = std::max(iterations, other.iterations);
  converged = converged && other.converged;
}

ProblemSource Simulated(sim::ViWorld world, std::uint64_t seed) {
  return [world = std::move(world), seed](int trial) {
    return sim::Measure(world, seed * 1000003u + static_cast<std::uint64_t>(trial));
  };
}

Result<GaugeConfiguration> RunConfiguration(const ProblemSource& source,
                                            const GaugeStudyOptions& options,
                                            ProgressBar* progress) {
  GaugeConfiguration result;
  for (GaugeSamples& samples : result.methods)
    samples.Resize(At(options.trials));
  const int num_converged = std::min(options.trials, options.converged_trials);
  std::vector<GaugeAgreement> free(At(num_converged)), prior(At(num_converged));
  const GaugeRunOptions paper = Paper(options);
  const Status status =
      ForEachTrial(options.trials, options.num_threads, progress, [&](int trial) -> Status {
        const auto problem = source(trial);
        if (!problem.ok()) return problem.status();
        for (const GaugeMethod method : kGaugeMethods) {
          const auto run = RunGauge(*problem, method, options.prior_weight, paper);
          if (!run.ok()) return run.status();
          result.methods[static_cast<int>(method)].Set(At(trial), *run);
        }
        if (trial >= num_converged) return {};
        const auto fixed = RunGauge(*problem, GaugeMethod::kFixed, 0.0, Converge(options));
        if (!fixed.ok()) return fixed.status();
        const auto f = RunGauge(*problem, GaugeMethod::kFree, 0.0, Converge(options));
        if (!f.ok()) return f.status();
        const auto p =
            RunGauge(*problem, GaugeMethod::kPrior, options.prior_weight, Converge(options));
        if (!p.ok()) return p.status();
        free[At(trial)].Include(*f, *fixed, *problem, true);
        prior[At(trial)].Include(*p, *fixed, *problem, false);
        return {};
      });
  if (!status.ok()) return status;
  for (const GaugeAgreement& trial : free)
    result.free.Include(trial);
  for (const GaugeAgreement& trial : prior)
    result.prior.Include(trial);
  return result;
}

Result<std::vector<GaugeWeight>> RunWeights(const ProblemSource& source,
                                            const GaugeStudyOptions& options,
                                            ProgressBar* progress) {
  std::vector<GaugeWeight> result(options.weights.size());
  for (std::size_t k = 0; k < result.size(); ++k) {
    result[k].weight = options.weights[k];
    result[k].samples.Resize(At(options.trials));
    result[k].light.Resize(At(options.trials));
  }
  const int num_converged = std::min(options.trials, options.converged_trials);
  std::vector<std::vector<GaugeAgreement>> agreements(At(num_converged),
                                                      std::vector<GaugeAgreement>(result.size()));
  const GaugeRunOptions paper = Paper(options);
  GaugeRunOptions light = paper;
  light.solve.initial_lambda = kLightDamping;
  const Status status =
      ForEachTrial(options.trials, options.num_threads, progress, [&](int trial) -> Status {
        const auto problem = source(trial);
        if (!problem.ok()) return problem.status();
        const bool converge = trial < num_converged;
        Result<GaugeRun> fixed = GaugeRun{};
        if (converge) fixed = RunGauge(*problem, GaugeMethod::kFixed, 0.0, Converge(options));
        if (!fixed.ok()) return fixed.status();
        for (std::size_t k = 0; k < result.size(); ++k) {
          const double weight = result[k].weight;
          const auto run = RunGauge(*problem, GaugeMethod::kPrior, weight, paper);
          if (!run.ok()) return run.status();
          result[k].samples.Set(At(trial), *run);
          const auto undamped = RunGauge(*problem, GaugeMethod::kPrior, weight, light);
          if (!undamped.ok()) return undamped.status();
          result[k].light.Set(At(trial), *undamped);
          if (!converge) continue;
          const auto last = RunGauge(*problem, GaugeMethod::kPrior, weight, Converge(options));
          if (!last.ok()) return last.status();
          // Without a prior the gauge is where the solve left it; with one it is where it belongs.
          agreements[At(trial)][k].Include(*last, *fixed, *problem, weight == 0.0);
        }
        return {};
      });
  if (!status.ok()) return status;
  for (const auto& trial : agreements) {
    for (std::size_t k = 0; k < result.size(); ++k) {
      result[k].agreement.Include(trial[k]);
    }
  }
  return result;
}

Result<std::vector<GaugePath>> RunPaths(const ProblemSource& source,
                                        const GaugeStudyOptions& options) {
  const auto problem = source(0);
  if (!problem.ok()) return problem.status();
  GaugeRunOptions watched = Paper(options);
  watched.timed_runs = 1;
  watched.record_steps = true;
  std::vector<GaugePath> paths;
  for (const double weight : options.path_weights) {
    auto run = RunGauge(*problem, GaugeMethod::kPrior, weight, watched);
    if (!run.ok()) return run.status();
    paths.push_back({weight, std::move(run->steps)});
  }
  return paths;
}

}  // namespace glissade::app
