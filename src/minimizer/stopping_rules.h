// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/minimizer/minimizer.h"

namespace glissade {

/// When a solve has converged. The loop (minimizer.cpp) asks; what is compared with what is here.
class StoppingRules {
 public:
  virtual ~StoppingRules() = default;
  /// Once, after the first linearization.
  virtual void Start(double cost, const NormalEquations& equations) = 0;
  /// After each linearization, the first included.
  [[nodiscard]] virtual bool GradientConverged(const NormalEquations& equations) const = 0;
  /// Before a step is applied. predicted: the decrease of the cost that the model promises for it.
  [[nodiscard]] virtual bool StepConverged(double step_norm, double predicted,
                                           double cost) const = 0;
  /// After a step was accepted and has lowered the cost to `cost` by `decrease`.
  [[nodiscard]] virtual bool CostConverged(double decrease, double cost) const = 0;
  /// After a step was rejected: whether what it promised was nothing to go on for.
  [[nodiscard]] virtual bool PromiseConverged(double predicted, double cost) const = 0;
  /// After a step was rejected whose promise is below the rounding of the cost: whether that is as
  /// far as steps can go.
  [[nodiscard]] virtual bool UnseenStepConverged() const = 0;
};

/// The rules of SolveOptions' tolerances: numbers without units, the same wherever the world has
/// its origin, and each bounded by the residuals, so that no single variable can blind them.
class RelativeRules final : public StoppingRules {
 public:
  RelativeRules(const SolveOptions& options, const Graph& graph, const SolverWorkspace& workspace)
      : options_(options), graph_(graph), w_(workspace) {}
  void Start(double cost, const NormalEquations& equations) override;
  [[nodiscard]] bool GradientConverged(const NormalEquations& equations) const override;
  [[nodiscard]] bool StepConverged(double step_norm, double predicted, double cost) const override;
  [[nodiscard]] bool CostConverged(double decrease, double cost) const override;
  [[nodiscard]] bool PromiseConverged(double predicted, double cost) const override;
  [[nodiscard]] bool UnseenStepConverged() const override { return options_.step_tolerance > 0.0; }

 private:
  const SolveOptions& options_;
  const Graph& graph_;
  const SolverWorkspace& w_;
  double initial_gradient_ = 0.0;
};

/// The course's absolute ones (SolveOptions::course_stop).
class CourseRules final : public StoppingRules {
 public:
  void Start(double cost, const NormalEquations&) override { initial_cost_ = cost; }
  [[nodiscard]] bool GradientConverged(const NormalEquations&) const override { return false; }
  [[nodiscard]] bool StepConverged(double step_norm, double, double) const override {
    return step_norm * step_norm <= 1e-6;
  }
  [[nodiscard]] bool CostConverged(double decrease, double cost) const override;
  [[nodiscard]] bool PromiseConverged(double, double) const override { return false; }
  [[nodiscard]] bool UnseenStepConverged() const override { return false; }

 private:
  double initial_cost_ = 0.0;
};

}  // namespace glissade
