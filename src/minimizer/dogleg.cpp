// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "minimizer/step_strategy.h"

namespace glissade {

namespace {

constexpr double kMinMu = 1e-8;
constexpr double kMaxMu = 1.0;
constexpr double kMuGrowth = 10.0;
constexpr double kMinRadius = 1e-32;
constexpr double kMaxRadius = 1e16;

double Norm(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v)
    sum += x * x;
  return std::sqrt(sum);
}

}  // namespace

void DoglegStrategy::Start() {
  radius_ = options_.initial_radius;
  mu_ = kMinMu;
}

// The Gauss-Newton step with mu diag(H) added; mu grows until the system can be solved.
StepStrategy::Outcome DoglegStrategy::ComputeGaussNewtonStep() {
  for (;; mu_ *= kMuGrowth) {
    DampingTerm damping = MakeDamping(options_, mu_);
    damping.identity = false;
    LinearSolverResult result;
    const Outcome outcome = SolveDamped(damping, &result);
    if (outcome != Outcome::kRetry) return outcome;
    if (mu_ * kMuGrowth > kMaxMu) return Outcome::kExhausted;
  }
}

void DoglegStrategy::ComputeScaledGradient() {
  const std::vector<double>& b = w_.equations.b();
  const std::size_t n = b.size();
  w_.dogleg_scale.resize(n);
  w_.dogleg_gradient.resize(n);  // D^-1 b: minus the gradient in the scaled space
  w_.dogleg_step.resize(n);      // D^-2 b: the same direction in the public one
  for (std::size_t k = 0; k < n; ++k) {
    const double d = std::sqrt(
        std::clamp(w_.equations.diagonal()[k], options_.min_diagonal, options_.max_diagonal));
    w_.dogleg_scale[k] = d;
    w_.dogleg_gradient[k] = b[k] / d;
    w_.dogleg_step[k] = b[k] / (d * d);
  }
  gradient_norm_ = Norm(w_.dogleg_gradient);
  const double curvature = w_.equations.QuadraticForm(w_.structure, *graph_, w_.dogleg_step);
  cauchy_length_ = curvature > 0.0 ? gradient_norm_ * gradient_norm_ / curvature : 0.0;
}

StepStrategy::Outcome DoglegStrategy::ComputeStep() {
  if (linearization_is_new_) {
    ComputeScaledGradient();
    const Outcome outcome = ComputeGaussNewtonStep();
    if (outcome != Outcome::kStep) return outcome;
    newton_norm_ = 0.0;
    const std::vector<double>& newton = w_.equations.step();
    for (std::size_t k = 0; k < newton.size(); ++k) {
      const double scaled = w_.dogleg_scale[k] * newton[k];
      newton_norm_ += scaled * scaled;
    }
    newton_norm_ = std::sqrt(newton_norm_);
    linearization_is_new_ = false;
  }
  // step = D^-1 (gradient_part * g + newton_part * (D newton)), g the scaled descent direction.
  double gradient_part = 0.0, newton_part = 1.0;
  const double cauchy_norm = cauchy_length_ * gradient_norm_;
  if (newton_norm_ <= radius_) {
    step_norm_ = newton_norm_;
  } else if (cauchy_norm >= radius_) {
    gradient_part = radius_ / gradient_norm_;
    newton_part = 0.0;
    step_norm_ = radius_;
  } else {
    // Where the segment from the Cauchy point c to the Gauss-Newton step n leaves the region:
    // |c + beta (n - c)| = radius.
    double c_dot_n = 0.0;
    for (std::size_t k = 0; k < w_.dogleg_scale.size(); ++k) {
      c_dot_n +=
          cauchy_length_ * w_.dogleg_gradient[k] * w_.dogleg_scale[k] * w_.equations.step()[k];
    }
    const double c2 = cauchy_norm * cauchy_norm;
    const double a = newton_norm_ * newton_norm_ - 2.0 * c_dot_n + c2;  // |n - c|^2
    const double b = c_dot_n - c2;                                      // c'(n - c)
    const double c = radius_ * radius_ - c2;
    const double root = std::sqrt(std::max(b * b + a * c, 0.0));
    const double beta = b <= 0.0 ? (root - b) / a : c / (b + root);
    gradient_part = (1.0 - beta) * cauchy_length_;
    newton_part = beta;
    step_norm_ = radius_;
  }
  for (std::size_t k = 0; k < w_.dogleg_step.size(); ++k) {
    w_.dogleg_step[k] = gradient_part * w_.dogleg_gradient[k] / w_.dogleg_scale[k] +
                        newton_part * w_.equations.step()[k];
  }
  predicted_ = w_.equations.ModelDecrease(w_.structure, *graph_, w_.dogleg_step);
  return Outcome::kStep;
}

void DoglegStrategy::Accepted(double gain_ratio) {
  if (gain_ratio < 0.25) radius_ *= 0.5;
  if (gain_ratio > 0.75) radius_ = std::min(std::max(radius_, 3.0 * step_norm_), kMaxRadius);
  mu_ = std::max(kMinMu, 2.0 * mu_ / kMuGrowth);
  linearization_is_new_ = true;
}

bool DoglegStrategy::Rejected() {
  radius_ *= 0.5;
  return radius_ > kMinRadius;
}

}  // namespace glissade
