// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Included by minimizer.cpp only.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "glissade/gauge/gauge_guard.h"
#include "glissade/graph/pools.h"
#include "glissade/linear/instruction_set.h"
#include "minimizer/graph_watch.h"
#include "minimizer/step_strategy.h"
#include "minimizer/stopping_rules.h"

namespace glissade {

/// One run of a trust-region method: applies the strategy's steps, measures, and decides.
class Minimizer {
 public:
  Minimizer(Graph* graph, SolverWorkspace* workspace, const SolveOptions& options,
            StepStrategy* strategy, StoppingRules* rules, Clock::time_point start)
      : graph_(graph),
        watch_(&workspace->watched_states),
        w_(*workspace),
        options_(options),
        strategy_(*strategy),
        rules_(*rules),
        summary_(workspace->summary),
        start_(start) {}

  void Run() {
    w_.solved.is_there = false;  // an analysis that fails leaves no structure to look it up in
    if (Status status = CheckInstructionSet(); !status.ok()) return Fail(std::move(status));
    if (Status status = options_.Validate(); !status.ok()) return Fail(std::move(status));
    if (Status status = graph_->ReadyToSolve(); !status.ok()) return Fail(std::move(status));
    if (Status status = gauge_.Begin(options_.gauge, graph_); !status.ok()) {
      return Fail(std::move(status));
    }
    w_.threads.Resize(options_.num_threads);
    summary_.num_threads = w_.threads.num_threads();
    summary_.num_threads_refused = options_.num_threads - summary_.num_threads;
    {
      const Timed timed(&summary_.time.analyze_s);
      Status status = AnalyzeForSolve(graph_, &w_, options_);
      if (!status.ok()) return Fail(std::move(status));
    }
    summary_.reduced = w_.choice.description;
    summary_.num_poses = static_cast<int>(w_.structure.poses().size());
    summary_.num_landmarks =
        static_cast<int>(w_.structure.landmarks().size()) + w_.structure.groups().num_landmarks;
    summary_.num_edges = w_.structure.num_edges();
    w_.solved.Begin(w_.structure, *graph_, options_.gauge);
    // Filled at the end, where a failure would come too late: states have changed.
    summary_.edges.reserve(graph_->edge_pools().size());
    if (!Linearize()) return;
    summary_.initial_cost = summary_.final_cost = lowest_cost_ = cost_;
    rules_.Start(cost_, w_.equations);
    strategy_.Start();
    iteration_.cost = cost_;
    iteration_.gradient_max = gradient_;
    iteration_.lambda = strategy_.Lambda();
    if (!Report() || GradientConverged()) return;

    while (!done_) {
      if (iteration_.iteration >= options_.max_iterations) return Stop(Termination::kMaxIterations);
      iteration_start_ = Clock::now();
      iteration_ = {.iteration = iteration_.iteration + 1};
      Iterate();
      if (done_ && !iteration_tried_) break;
      iteration_.cost = cost_;
      iteration_.gradient_max = gradient_;
      iteration_.lambda = strategy_.Lambda();
      if (!Report()) return;
    }
  }

 private:
  void Stop(Termination termination) {
    summary_.termination = termination;
    done_ = true;
  }

  void Fail(Status status) {
    summary_.status = std::move(status);
    Stop(Termination::kFailed);
  }

  bool OutOfTime() {
    if (SecondsSince(start_) <= options_.max_time_s) return false;
    Stop(Termination::kMaxTime);
    return true;
  }

  bool GradientConverged() {
    if (!rules_.GradientConverged(w_.equations)) return false;
    Stop(Termination::kConvergedGradient);
    return true;
  }

  bool Linearize() {
    const Timed timed(&summary_.time.linearize_s);
    double cost = 0.0;
    Status status = w_.equations.Linearize(w_.structure, graph_, &w_.threads, &cost);
    if (!status.ok()) {
      Fail(std::move(status));
      return false;
    }
    if (summary_.iterations.empty()) cost_ = cost;
    gradient_ = w_.equations.MaxGradient();
    // Squares of Jacobians that overflow would make any gradient a small one.
    const bool finite = std::isfinite(w_.equations.MaxDiagonal());
    if (!finite || !std::isfinite(gradient_)) {
      Fail({StatusCode::kNotFinite, finite ? "the gradient is not finite"
                                           : "J'J is not finite: the Jacobians are too large"});
      gradient_ = 0.0;
      return false;
    }
    return true;
  }

  /// Records the iteration; false if the callback wants to stop, or has made it impossible to go
  /// on.
  bool Report() {
    iteration_.time_s = SecondsSince(iteration_start_);
    iteration_.total_time_s = SecondsSince(start_);
    summary_.iterations.push_back(iteration_);
    summary_.time.total_s = iteration_.total_time_s;
    if (options_.verbose) {
      if (iteration_.iteration == 0) std::fputs((IterationTableHeader() + "\n").c_str(), stderr);
      std::fputs((ToString(iteration_) + "\n").c_str(), stderr);
    }
    return !options_.callback || CallBack();
  }

  bool CallBack() {
    watch_.Keep(*graph_);
    const CallbackAction action = options_.callback(iteration_);
    if (const char* what = watch_.FindChange(*graph_); what != nullptr) {
      Fail({StatusCode::kInvalidArgument, what});
      return false;
    }
    if (action == CallbackAction::kContinue || done_) return true;
    if (action == CallbackAction::kStop) {
      Stop(Termination::kCancelled);
    } else {
      Fail({StatusCode::kInvalidArgument, "the callback's return value is no CallbackAction"});
    }
    return false;
  }

  void Reject() {
    iteration_.accepted = false;
    ++summary_.rejected_steps;
    ++rejected_in_row_;
  }

  void RejectStep() {
    Reject();
    if (OutOfTime()) return;
    if (!strategy_.Rejected()) Stop(Termination::kNoProgress);
  }

  /// False if there is no step; the iteration is then over.
  bool ComputeStep() {
    const StepStrategy::Outcome outcome = strategy_.ComputeStep();
    iteration_.linear_iterations = strategy_.linear_iterations();
    switch (outcome) {
      case StepStrategy::Outcome::kStep:
        return true;
      case StepStrategy::Outcome::kRetry:
        Reject();
        return false;
      case StepStrategy::Outcome::kExhausted:
        Reject();
        Fail(strategy_.failure());
        return false;
      case StepStrategy::Outcome::kOutOfTime:
        iteration_tried_ = false;
        Stop(Termination::kMaxTime);
        return false;
    }
    return false;
  }

  double StepNorm() const {
    double sum = 0.0;
    for (const double x : strategy_.step())
      sum += x * x;
    return std::sqrt(sum);
  }

  bool StepConverged() {
    if (!rules_.StepConverged(iteration_.step_norm, strategy_.predicted(), cost_)) return false;
    Stop(rejected_in_row_ > 0 && KeepsFirstEstimates() ? Termination::kConvergedFirstEstimates
                                                       : Termination::kConvergedStep);
    return true;
  }

  /// Some Jacobian is not that of its residual.
  bool KeepsFirstEstimates() const {
    bool any = false;
    for (const auto& pool : graph_->vertex_pools())
      any |= !pool->first_estimates().empty();
    return any && graph_->first_estimates() != FirstEstimates::kOff;
  }

  void Iterate() {
    iteration_tried_ = false;
    if (OutOfTime()) return;
    iteration_tried_ = true;
    if (!ComputeStep()) return;
    iteration_.step_norm = StepNorm();
    if (StepConverged()) {
      iteration_tried_ = false;  // not applied
      return;
    }
    const double predicted = strategy_.predicted();
    if (!std::isfinite(iteration_.step_norm) || !std::isfinite(predicted)) {
      iteration_.step_norm = 0.0;  // so large a step that its square is no number
      return RejectStep();
    }

    double trial_cost = 0.0;
    TrialStates trial(graph_);
    const StepFailure failure = MeasureTrial(&trial_cost);
    const double decrease = failure.ok() ? cost_ - trial_cost : 0.0;
    // A predicted decrease below the rounding of the cost cannot be seen in the cost: the step is
    // then taken on trust, as long as the cost does not rise by more than that rounding above the
    // lowest so far: such steps do not add up.
    const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * cost_;
    const bool invisible = predicted >= 0.0 && predicted <= rounding;
    iteration_.cost_change = decrease;
    // Of a hopeless step it can be beyond what a double holds.
    constexpr double kMost = std::numeric_limits<double>::max();
    const double gain_ratio = invisible ? 1.0 : strategy_.GainRatio(decrease);
    iteration_.gain_ratio = std::isnan(gain_ratio) ? 0.0 : std::clamp(gain_ratio, -kMost, kMost);
    const bool accept =
        failure.ok() && predicted >= 0.0 &&
        (invisible ? trial_cost <= lowest_cost_ + rounding
                   : decrease > 0.0 && iteration_.gain_ratio > options_.min_relative_decrease);
    if (!accept) {
      if (!failure.ok()) return RejectStep();
      const bool promise = rules_.PromiseConverged(predicted, cost_);
      // One may fail by the cost's noise alone; shorter ones get nearer. The third is the last.
      const bool unseen = invisible && rejected_in_row_ >= 2 && rules_.UnseenStepConverged();
      if (!promise && !unseen) return RejectStep();
      Reject();
      return Stop(rejected_in_row_ > 1 && KeepsFirstEstimates()
                      ? Termination::kConvergedFirstEstimates
                  : promise ? Termination::kConvergedCost
                            : Termination::kConvergedStep);
    }

    trial.Keep();
    ++summary_.accepted_steps;
    rejected_in_row_ = 0;
    cost_ = summary_.final_cost = trial_cost;
    lowest_cost_ = std::min(lowest_cost_, cost_);
    strategy_.Accepted(iteration_.gain_ratio);
    if (rules_.CostConverged(decrease, cost_)) return Stop(Termination::kConvergedCost);
    if (OutOfTime()) return;
    // Of the last step there is, nobody may ask for derivatives.
    if (iteration_.iteration >= options_.max_iterations && options_.gradient_tolerance == 0.0 &&
        !options_.callback) {
      return;
    }
    if (!Linearize()) return;
    GradientConverged();
  }

  StepFailure MeasureTrial(double* cost) {
    const Timed timed(&summary_.time.cost_s);
    ApplyStep(w_.structure, strategy_.step(), graph_);
    return w_.equations.Cost(w_.structure, *graph_, &w_.threads, cost);
  }

  Graph* graph_;
  GaugeGuard gauge_;
  GraphWatch watch_;
  SolverWorkspace& w_;
  const SolveOptions& options_;
  StepStrategy& strategy_;
  StoppingRules& rules_;
  SolveSummary& summary_;
  const Clock::time_point start_;
  Clock::time_point iteration_start_ = start_;
  IterationSummary iteration_;
  bool iteration_tried_ = false;
  int rejected_in_row_ = 0;
  bool done_ = false;
  double cost_ = 0.0;
  double lowest_cost_ = 0.0;
  double gradient_ = 0.0;
};

}  // namespace glissade
