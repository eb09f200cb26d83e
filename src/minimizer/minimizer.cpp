// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/minimizer/minimizer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include "glissade/vertices/inverse_depth.h"

namespace glissade {

namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Adds the time of its scope to a counter.
class Timed {
 public:
  explicit Timed(double* seconds) : seconds_(seconds), start_(Clock::now()) {}
  ~Timed() { *seconds_ += SecondsSince(start_); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  double* seconds_;
  Clock::time_point start_;
};

/// One run of Levenberg-Marquardt.
class LevenbergMarquardt {
 public:
  LevenbergMarquardt(Graph* graph, SolverWorkspace* workspace, const SolveOptions& options)
      : graph_(graph), w_(*workspace), options_(options), summary_(workspace->summary) {}

  void Run() {
    Reset();
    if (Status status = options_.Validate(); !status.ok()) return Fail(std::move(status));
    w_.threads.Resize(options_.num_threads);
    {
      const Timed timed(&summary_.time.analyze_s);
      Status status = w_.structure.Analyze(
          graph_, {.allow_duplicate_observations = options_.allow_duplicate_observations,
                   .fuse_reprojections = options_.fuse_reprojections});
      if (!status.ok()) return Fail(std::move(status));
    }
    summary_.num_poses = static_cast<int>(w_.structure.poses().size());
    summary_.num_landmarks = static_cast<int>(w_.structure.landmarks().size()) +
                             w_.structure.reprojections().num_landmarks;
    summary_.num_edges = w_.structure.num_edges();
    if (!Linearize()) return;
    summary_.initial_cost = summary_.final_cost = cost_;
    initial_gradient_ = gradient_;
    lambda_ = options_.initial_lambda;
    if (options_.damping != Damping::kDiagonal) {
      const double largest = w_.equations.MaxDiagonal();
      lambda_ *= largest > 0.0 ? largest : 1.0;
    }
    iteration_.cost = cost_;
    iteration_.gradient_max = gradient_;
    iteration_.lambda = lambda_;
    if (!Report() || GradientConverged()) return;

    while (!done_) {
      if (iteration_.iteration >= options_.max_iterations) return Stop(Termination::kMaxIterations);
      iteration_start_ = Clock::now();
      iteration_ = {.iteration = iteration_.iteration + 1};
      Iterate();
      if (done_ && !iteration_tried_) break;
      iteration_.cost = cost_;
      iteration_.gradient_max = gradient_;
      iteration_.lambda = lambda_;
      if (!Report()) return;
    }
  }

 private:
  void Reset() {
    // In place, so that the storage of the last summary serves again.
    std::vector<IterationSummary> iterations = std::move(summary_.iterations);
    iterations.clear();
    iterations.reserve(static_cast<std::size_t>(std::clamp(options_.max_iterations, 0, 255)) + 1);
    summary_ = {};
    summary_.iterations = std::move(iterations);
  }

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
    if (gradient_ > options_.gradient_tolerance * initial_gradient_ || options_.course_stop) {
      return false;
    }
    if (options_.gradient_tolerance == 0.0 && initial_gradient_ > 0.0) return false;
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
    if (!std::isfinite(gradient_)) {
      Fail({StatusCode::kNotFinite, "the gradient is not finite"});
      return false;
    }
    return true;
  }

  /// Records the iteration; false if the callback wants to stop.
  bool Report() {
    iteration_.time_s = SecondsSince(iteration_start_);
    iteration_.total_time_s = SecondsSince(start_);
    summary_.iterations.push_back(iteration_);
    summary_.time.total_s = iteration_.total_time_s;
    if (options_.verbose) {
      if (iteration_.iteration == 0) std::fputs((IterationTableHeader() + "\n").c_str(), stderr);
      std::fputs((ToString(iteration_) + "\n").c_str(), stderr);
    }
    if (options_.callback && options_.callback(iteration_) == CallbackAction::kStop && !done_) {
      Stop(Termination::kCancelled);
      return false;
    }
    return true;
  }

  void Reject() {
    iteration_.accepted = false;
    ++summary_.rejected_steps;
    lambda_ *= nu_;
    nu_ *= 2.0;
    if (lambda_ > options_.max_lambda || !std::isfinite(lambda_)) Stop(Termination::kNoProgress);
  }

  /// Computes dx; false if there is none (the iteration is then over).
  bool ComputeStep(const DampingTerm& damping, LinearSolverResult* result) {
    Status status;
    {
      const Timed timed(&summary_.time.eliminate_s);
      status = w_.equations.Eliminate(w_.structure, *graph_, damping, &w_.threads);
    }
    if (OutOfTime()) return false;
    if (status.ok()) {
      const Timed timed(&summary_.time.solve_s);
      status = w_.equations.Solve(w_.structure, *graph_, w_.Solver(options_), &w_.threads, result);
    }
    if (OutOfTime()) return false;
    if (status.ok()) return true;
    // Too little information for this lambda: more damping helps, where it reaches.
    Reject();
    const bool beyond_damping = damping.reduced_only && status.code() == StatusCode::kSingular &&
                                status.vertex() && status.message().starts_with("landmark");
    if (beyond_damping || done_) Fail(std::move(status));
    return false;
  }

  bool StepConverged(double step_norm) {
    if (options_.course_stop) {
      if (step_norm * step_norm > 1e-6) return false;
    } else {
      if (options_.step_tolerance == 0.0 ||
          step_norm > options_.step_tolerance * (StateNorm() + options_.step_tolerance)) {
        return false;
      }
    }
    Stop(Termination::kConvergedStep);
    return true;
  }

  void Iterate() {
    iteration_tried_ = false;
    if (OutOfTime()) return;
    iteration_tried_ = true;
    const DampingTerm damping = MakeDamping(options_, lambda_);
    LinearSolverResult result;
    if (!ComputeStep(damping, &result)) return;
    iteration_.linear_iterations = result.iterations;
    iteration_.step_norm = w_.equations.StepNorm();
    if (StepConverged(iteration_.step_norm)) {
      iteration_tried_ = false;  // not applied
      return;
    }
    const double predicted = w_.equations.ModelDecrease(w_.structure, damping, result);

    double trial_cost = 0.0;
    Status status;
    {
      const Timed timed(&summary_.time.cost_s);
      graph_->SaveStates();
      ApplyStep(w_.structure, w_.equations.step(), graph_);
      status = w_.equations.Cost(w_.structure, *graph_, &w_.threads, &trial_cost);
    }
    const double decrease = cost_ - trial_cost;
    // A predicted decrease below the rounding of the cost cannot be seen in the cost: the step is
    // then taken on trust, as long as the cost does not rise by more than that rounding.
    const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * cost_;
    const bool invisible = predicted >= 0.0 && predicted <= rounding;
    iteration_.cost_change = status.ok() ? decrease : 0.0;
    iteration_.gain_ratio = invisible ? 1.0 : GainRatio(damping, decrease, predicted);
    const bool accept =
        status.ok() && predicted >= 0.0 && std::isfinite(predicted) &&
        (invisible ? decrease >= -rounding : decrease > 0.0 && iteration_.gain_ratio > 0.0);
    if (!accept) {
      graph_->RestoreStates();
      if (status.ok() && options_.cost_tolerance > 0.0 && !options_.course_stop &&
          std::abs(predicted) <= options_.cost_tolerance * cost_) {
        iteration_.accepted = false;
        ++summary_.rejected_steps;
        return Stop(Termination::kConvergedCost);
      }
      if (OutOfTime()) return;
      return Reject();
    }

    ++summary_.accepted_steps;
    cost_ = summary_.final_cost = trial_cost;
    // Nielsen's update; the course's variant lets no accepted step raise lambda.
    const double t = 2.0 * iteration_.gain_ratio - 1.0;
    const double most = damping.reduced_only ? 2.0 / 3.0 : 2.0;
    const double factor = std::clamp(1.0 - t * t * t, 1.0 / 3.0, most);
    lambda_ = std::max(lambda_ * factor, options_.min_lambda);
    nu_ = 2.0;
    if (CostConverged(decrease) || OutOfTime()) return;
    if (!Linearize()) return;
    GradientConverged();
  }

  double GainRatio(const DampingTerm& damping, double decrease, double predicted) const {
    if (!damping.reduced_only) return predicted > 0.0 ? decrease / predicted : -1.0;
    // The course's: in units of sum of Chi2, with its guard against division by zero.
    const double step = w_.equations.StepNorm();
    const double model = damping.lambda * step * step + w_.equations.GradientDotStep() + 1e-3;
    return 2.0 * decrease / model;
  }

  bool CostConverged(double decrease) {
    if (options_.course_stop) {
      if (std::sqrt(2.0 * cost_) > 1e-6 * 2.0 * summary_.initial_cost) return false;
    } else {
      if (options_.cost_tolerance == 0.0) return false;
      if (std::abs(decrease) > options_.cost_tolerance * (cost_ + decrease)) return false;
    }
    Stop(Termination::kConvergedCost);
    return true;
  }

  /// |x| over the ambient states of all free vertices.
  double StateNorm() const {
    double sum = 0.0;
    const auto add = [&](std::int32_t pool, std::int32_t index) {
      const VertexPoolBase& vertices = *graph_->vertex_pools()[static_cast<std::size_t>(pool)];
      const double* x = vertices.Data(index);
      for (int k = 0; k < vertices.ops().ambient_dim; ++k)
        sum += x[k] * x[k];
    };
    for (const PoseBlock& pose : w_.structure.poses())
      add(pose.pool, pose.index);
    for (const LandmarkBlock& landmark : w_.structure.landmarks()) {
      add(landmark.pool, landmark.index);
    }
    const VertexPoolBase* depths = graph_->PoolOf(&kTypeInfo<VertexInverseDepth>);
    for (const std::int32_t landmark : w_.structure.reprojections().landmark_of_lane) {
      if (landmark >= 0) add(depths->id(), landmark);
    }
    return std::sqrt(sum);
  }

  Graph* graph_;
  SolverWorkspace& w_;
  const SolveOptions& options_;
  SolveSummary& summary_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point iteration_start_ = start_;
  IterationSummary iteration_;
  bool iteration_tried_ = false;
  bool done_ = false;
  double cost_ = 0.0;
  double gradient_ = 0.0;
  double initial_gradient_ = 0.0;
  double lambda_ = 0.0;
  double nu_ = 2.0;
};

}  // namespace

LinearSolver* SolverWorkspace::Solver(const SolveOptions& options) {
  if (options.linear_solver != nullptr) return options.linear_solver;
  switch (options.linear_solver_type) {
    case LinearSolverType::kDenseCholesky:
      return &dense_cholesky;
    case LinearSolverType::kSparseCholesky:
      return &sparse_cholesky;
    case LinearSolverType::kPcg:
      pcg.set_options(options.pcg);
      return &pcg;
    case LinearSolverType::kAuto:
      break;
  }
  // Small fronts run at about a third of the speed of one dense factorization.
  constexpr double kWorthwhile = 0.3;
  const ReducedSystem system = equations.reduced();
  if (system.pattern.empty()) return &dense_cholesky;
  sparse_cholesky.Analyze(system);
  if (sparse_cholesky.FlopRatio() < kWorthwhile) return &sparse_cholesky;
  return &dense_cholesky;
}

const SolveSummary& Solve(Graph* graph, SolverWorkspace* workspace, const SolveOptions& options) {
  const Clock::time_point start = Clock::now();
  LevenbergMarquardt(graph, workspace, options).Run();
  workspace->summary.time.total_s = SecondsSince(start);
  return workspace->summary;
}

void ApplyStep(const Structure& structure, const std::vector<double>& step, Graph* graph) {
  for (const auto& pool : graph->vertex_pools()) {
    pool->Plus(step.data(), structure.step_offsets(pool->id()).data(), pool->size());
  }
  for (const PoseBlock& pose : structure.poses()) {
    if (pose.free_tangent < 0) continue;
    VertexPoolBase& pool = *graph->vertex_pools()[static_cast<std::size_t>(pose.pool)];
    graph->free_tangents()[static_cast<std::size_t>(pose.free_tangent)].Plus(
        step.data() + pose.offset, pool.Data(pose.index));
  }
}

DampingTerm MakeDamping(const SolveOptions& options, double lambda) {
  DampingTerm damping;
  damping.lambda = lambda;
  damping.identity = options.damping == Damping::kIdentity;
  damping.reduced_only = options.damping == Damping::kPoseBlock;
  damping.min_diagonal = options.min_diagonal;
  damping.max_diagonal = options.max_diagonal;
  return damping;
}

}  // namespace glissade
