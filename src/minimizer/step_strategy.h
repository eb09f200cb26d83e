// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

#include "glissade/minimizer/minimizer.h"

namespace glissade {

using Clock = std::chrono::steady_clock;

inline double SecondsSince(Clock::time_point start) {
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

/// How a method finds its next step from the present linearization. The loop around it
/// (minimizer.cpp) applies steps, measures costs and decides when to stop.
class StepStrategy {
 public:
  enum class Outcome {
    kStep,       ///< step() and predicted() are set
    kRetry,      ///< the system could not be solved; the strategy has become more careful
    kExhausted,  ///< ... and cannot become more so; failure() says why
    kOutOfTime,
  };

  StepStrategy(Graph* graph, SolverWorkspace* workspace, const SolveOptions& options,
               Clock::time_point start)
      : graph_(graph), w_(*workspace), options_(options), start_(start) {}
  virtual ~StepStrategy() = default;

  /// Called once, after the first linearization.
  virtual void Start() = 0;
  virtual Outcome ComputeStep() = 0;
  [[nodiscard]] virtual const std::vector<double>& step() const = 0;
  /// Decrease of the model when going by step().
  [[nodiscard]] double predicted() const { return predicted_; }
  /// Actual over predicted decrease of the cost.
  [[nodiscard]] virtual double GainRatio(double decrease) const {
    return predicted_ > 0.0 ? decrease / predicted_ : -1.0;
  }
  virtual void Accepted(double gain_ratio) = 0;
  /// False: there is nothing more careful to try.
  virtual bool Rejected() = 0;
  /// What the iteration table shows as lambda.
  [[nodiscard]] virtual double Lambda() const = 0;
  [[nodiscard]] int linear_iterations() const { return linear_iterations_; }
  [[nodiscard]] const StepFailure& failure() const { return failure_; }

 protected:
  /// Eliminates and solves with the given damping: equations.step() holds dx.
  Outcome SolveDamped(const DampingTerm& damping, LinearSolverResult* result);
  /// PcgOptions::forcing, or what kAuto takes for it.
  [[nodiscard]] double Forcing() const;
  /// Relative decrease of the cost by the last step that was accepted; 1 before there is one.
  [[nodiscard]] double Progress() const;
  [[nodiscard]] bool OutOfTime() const { return SecondsSince(start_) > options_.max_time_s; }

  Graph* graph_;
  SolverWorkspace& w_;
  const SolveOptions& options_;
  Clock::time_point start_;
  double predicted_ = 0.0;
  int linear_iterations_ = 0;
  StepFailure failure_;
};

/// Levenberg-Marquardt with Nielsen's update of lambda (Madsen, Nielsen, Tingleff 2004, Alg. 3.16);
/// Ceres' rule for its radius is the same with lambda = 1 / radius.
class LevenbergMarquardtStrategy : public StepStrategy {
 public:
  using StepStrategy::StepStrategy;
  void Start() override;
  Outcome ComputeStep() override;
  [[nodiscard]] const std::vector<double>& step() const override { return w_.equations.step(); }
  void Accepted(double gain_ratio) override { Lower(gain_ratio, 2.0); }
  bool Rejected() override;
  [[nodiscard]] double Lambda() const override { return lambda_; }

 protected:
  /// lambda <- lambda max(1/3, 1 - (2 gain_ratio - 1)^3), but by no more than a factor of `most`.
  void Lower(double gain_ratio, double most);

  DampingTerm damping_;

 private:
  double lambda_ = 0.0;
  double scale_ = 1.0;  // what lambda is relative to
  double nu_ = 2.0;
};

/// The course's variant (Damping::kPoseBlock): lambda is added to the reduced system, the gain
/// ratio has a guard against division by zero in it, and no accepted step raises lambda.
class CourseStrategy final : public LevenbergMarquardtStrategy {
 public:
  using LevenbergMarquardtStrategy::LevenbergMarquardtStrategy;
  [[nodiscard]] double GainRatio(double decrease) const override;
  void Accepted(double gain_ratio) override { Lower(gain_ratio, 2.0 / 3.0); }
};

/// Powell's dogleg between the Cauchy point and the Gauss-Newton step, both in the space scaled by
/// sqrt(diag(H)) (Nocedal and Wright, Numerical Optimization, Sec. 4.1). The Gauss-Newton system is
/// regularized just enough to be solvable.
class DoglegStrategy final : public StepStrategy {
 public:
  using StepStrategy::StepStrategy;
  void Start() override;
  Outcome ComputeStep() override;
  [[nodiscard]] const std::vector<double>& step() const override { return w_.dogleg_step; }
  void Accepted(double gain_ratio) override;
  bool Rejected() override;
  [[nodiscard]] double Lambda() const override { return radius_; }

 private:
  Outcome ComputeGaussNewtonStep();
  void ComputeScaledGradient();

  double radius_ = 0.0;
  double mu_ = 0.0;  // regularization of the Gauss-Newton system
  bool linearization_is_new_ = true;
  double gradient_norm_ = 0.0;  // of the scaled gradient
  double cauchy_length_ = 0.0;  // of the step to the Cauchy point, over gradient_norm_
  double newton_norm_ = 0.0;    // of the scaled Gauss-Newton step
  double step_norm_ = 0.0;      // of the scaled dogleg step
};

}  // namespace glissade
