// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "minimizer/step_strategy.h"

namespace glissade {

StepStrategy::Outcome StepStrategy::SolveDamped(const DampingTerm& damping,
                                                LinearSolverResult* result) {
  LinearSolver* const solver = w_.Solver(options_, w_.choice.type);
  const LentThreads lent(solver, &w_.threads);
  SolverWorkspace::Wish wish;
  {
    const Timed timed(&w_.summary.time.solve_s);
    wish = w_.AskWhatToStore(solver);
  }
  w_.solved.is_there = false;  // until there is a step again
  {
    const Timed timed(&w_.summary.time.eliminate_s);
    failure_ =
        w_.equations.Eliminate(w_.structure, *graph_, damping, wish.form, &w_.threads, wish.blocks);
  }
  if (OutOfTime()) return Outcome::kOutOfTime;
  const bool eliminated = failure_.ok();
  if (eliminated) {
    const Timed timed(&w_.summary.time.solve_s);
    SolveRequest request = MakeRequest(options_, Forcing(), Progress());
    request.stop = [](void* self) { return static_cast<const StepStrategy*>(self)->OutOfTime(); };
    request.stop_data = this;
    failure_ = w_.equations.Solve(w_.structure, *graph_, solver, request, &w_.threads, result);
    linear_iterations_ = result->iterations;
  }
  if (failure_.ok()) w_.solved.Keep(w_.structure, *graph_);
  if (OutOfTime()) return Outcome::kOutOfTime;
  if (failure_.ok()) return Outcome::kStep;
  // Too little information for this damping: more of it helps, where it reaches.
  return !eliminated && damping.reduced_only ? Outcome::kExhausted : Outcome::kRetry;
}

// kAuto's conjugate gradients are inexact.
double StepStrategy::Forcing() const {
  constexpr double kForcing = 0.1;
  return ChoosesSolver(options_) && options_.pcg.forcing == 0.0 ? kForcing : options_.pcg.forcing;
}

double StepStrategy::Progress() const {
  for (auto it = w_.summary.iterations.rbegin(); it != w_.summary.iterations.rend(); ++it) {
    if (it->iteration > 0 && it->accepted && it->cost > 0.0) return it->cost_change / it->cost;
  }
  return 1.0;
}

void LevenbergMarquardtStrategy::Start() {
  lambda_ = options_.initial_lambda;
  if (options_.damping != Damping::kDiagonal) {
    const double largest = w_.equations.MaxDiagonal();
    if (largest > 0.0) scale_ = largest;
  }
  lambda_ = std::min(lambda_ * scale_, std::numeric_limits<double>::max());
}

StepStrategy::Outcome LevenbergMarquardtStrategy::ComputeStep() {
  damping_ = MakeDamping(options_, lambda_);
  LinearSolverResult result;
  const Outcome outcome = SolveDamped(damping_, &result);
  if (outcome == Outcome::kStep) {
    predicted_ = w_.equations.ModelDecrease(w_.structure, damping_, result);
  } else if (outcome == Outcome::kRetry && !Rejected()) {
    return Outcome::kExhausted;
  }
  return outcome;
}

double CourseStrategy::GainRatio(double decrease) const {
  // In units of sum of Chi2.
  const double step = w_.equations.StepNorm();
  const double model = damping_.lambda * step * step + w_.equations.GradientDotStep() + 1e-3;
  return 2.0 * decrease / model;
}

void LevenbergMarquardtStrategy::Lower(double gain_ratio, double most) {
  const double t = 2.0 * gain_ratio - 1.0;
  const double factor = std::clamp(1.0 - t * t * t, 1.0 / 3.0, most);
  lambda_ = std::max(lambda_ * factor, options_.min_lambda);
  nu_ = 2.0;
}

bool LevenbergMarquardtStrategy::Rejected() {
  // From no damping at all there must be a way up.
  constexpr double kLeast = 1e-15;
  const double more = nu_ * std::max({lambda_, options_.min_lambda, kLeast * scale_});
  nu_ *= 2.0;
  lambda_ = std::min(more, std::numeric_limits<double>::max());
  return more <= options_.max_lambda && std::isfinite(more);
}

}  // namespace glissade
