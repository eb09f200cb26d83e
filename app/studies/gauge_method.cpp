// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/gauge_method.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/lie/so3.h"

namespace glissade::app {

namespace {

GaugeStep Measure(const IterationSummary& it, const Graph& graph, const sim::ViHandles& handles,
                  const sim::ViProblem& problem) {
  GaugeStep step;
  step.iteration = it.iteration;
  for (std::size_t k = 0; k < handles.observations.size(); ++k) {
    const auto camera = static_cast<std::size_t>(problem.observations[k].camera);
    // Chi2 is in sigmas.
    step.reprojection_px +=
        std::sqrt(graph.Chi2(handles.observations[k]).value()) * problem.cameras[camera].sigma_px;
  }
  step.reprojection_px /=
      static_cast<double>(std::max<std::size_t>(1, handles.observations.size()));
  const Pose& now = graph.Get(handles.poses[0]).pose;
  const Pose& start = problem.start.poses[0].pose;
  step.prior_position_m = (now.p() - start.p()).norm();
  const Vector3 dphi = so3::Log(Quaternion(now.q() * start.q().conjugate()));
  step.prior_yaw_rad = std::abs(dphi[2]);
  return step;
}

}  // namespace

const char* ToString(GaugeMethod method) {
  return method == GaugeMethod::kFixed ? "fixed" : method == GaugeMethod::kFree ? "free" : "prior";
}

Gauge MakeGauge(GaugeMethod method, double weight, const sim::ViProblem& problem,
                const sim::ViHandles& handles) {
  const Pose& reference = problem.start.poses[0].pose;
  if (method == GaugeMethod::kFixed) return Gauge::Fixed{handles.poses[0], reference};
  if (method == GaugeMethod::kFree || weight == 0.0) return Gauge::Free;
  return Gauge::Prior{handles.poses[0], weight, reference};
}

SolveOptions PaperOptions() {
  SolveOptions options;
  options.max_iterations = 200;
  options.cost_tolerance = 1e-6;
  options.gradient_tolerance = 0.0;
  options.step_tolerance = 1e-8;
  options.initial_lambda = 1e-4;
  options.min_relative_decrease = 1e-3;
  return options;
}

SolveOptions ConvergedOptions(bool polish) {
  SolveOptions options;
  options.max_iterations = 2000;
  options.cost_tolerance = 0.0;
  options.gradient_tolerance = 0.0;
  options.step_tolerance = 1e-12;
  if (polish) {
    options.initial_lambda = options.min_lambda;
    options.max_iterations = 20;
  }
  return options;
}

Result<GaugeRun> RunGauge(const sim::ViProblem& problem, GaugeMethod method, double weight,
                          const GaugeRunOptions& options) {
  Problem start;
  auto handles = sim::AddToGraph(problem, {}, &start);
  if (!handles.ok()) return handles.status();
  SolveOptions solve = options.converge ? ConvergedOptions() : options.solve;
  solve.linear_solver_type = options.solve.linear_solver_type;
  solve.gauge = MakeGauge(method, weight, problem, *handles);
  GaugeRun run;
  if (options.record_steps) {
    Problem watched = start.Clone();
    SolveOptions watch = solve;
    watch.callback = [&](const IterationSummary& it) {
      if (it.accepted) run.steps.push_back(Measure(it, watched, *handles, problem));
      return CallbackAction::kContinue;
    };
    watched.Solve(watch);
  }
  run.time_ms = std::numeric_limits<double>::infinity();
  for (int k = 0; k < std::max(1, options.timed_runs); ++k) {
    Problem solved = start.Clone();
    const SolveSummary& summary = solved.Solve(solve);
    if (!summary.ok()) return summary.status;
    run.time_ms = std::min(run.time_ms, 1e3 * summary.time.total_s);
    run.iterations = summary.accepted_steps + summary.rejected_steps;
    run.converged = summary.converged();
    if (k > 0) continue;
    if (options.converge) {
      SolveOptions polish = ConvergedOptions(true);
      polish.gauge = solve.gauge;
      polish.linear_solver_type = solve.linear_solver_type;
      const SolveSummary& last = solved.Solve(polish);
      if (!last.ok()) return last.status;
    }
    run.states = sim::StatesOf(solved, *handles);
    const auto cost = solved.Cost();
    if (!cost.ok()) return cost.status();
    run.cost = cost.value();
  }
  const auto errors = sim::AlignedErrors(run.states, problem.truth);
  if (!errors.ok()) return errors.status();
  run.errors = *errors;
  return run;
}

sim::ViStates MovedToStart(const sim::ViStates& states, const sim::ViProblem& problem) {
  return sim::Moved(states, eval::AlignPose(states.poses[0].pose, problem.start.poses[0].pose));
}

}  // namespace glissade::app
