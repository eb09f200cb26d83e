// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "minimizer/stopping_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/graph/pools.h"
#include "glissade/vertices/pose.h"

namespace glissade {

namespace {

/// max_i |g_i| / |J_i|, J_i the i-th column of J: at most |r|, whatever units the variables have.
double ScaledGradient(const NormalEquations& equations) {
  const std::vector<double>& b = equations.b();
  const std::vector<double>& diagonal = equations.diagonal();
  double largest = 0.0;
  for (std::size_t k = 0; k < b.size(); ++k) {
    if (diagonal[k] > 0.0) largest = std::max(largest, b[k] * b[k] / diagonal[k]);
  }
  return std::sqrt(largest);
}

/// The cost that the rounding of the states' own numbers makes at a perfect fit: 1/2 sum H_ii (eps
/// x_i)^2. A position 6.4e6 m from the origin has 1e-9 m of it, and residuals then too.
double RoundingCost(const Graph& graph, const SolverWorkspace& w) {
  const std::vector<double>& diagonal = w.equations.diagonal();
  double sum = 0.0;
  for (const auto& base : graph.vertex_pools()) {
    const VertexPoolBase& pool = *base;
    const int dim = pool.ops().tangent_dim, ambient = pool.ops().ambient_dim;
    // Coordinates that are the state's numbers; all others (rotations) are of the order of 1.
    const int plain = ambient == dim ? dim : pool.ops().type == &kTypeInfo<VertexPose> ? 3 : 0;
    const std::vector<std::int32_t>& offsets = w.structure.step_offsets(pool.id());
    for (int k = 0; k < pool.size(); ++k) {
      const std::int32_t offset = offsets[static_cast<std::size_t>(k)];
      if (offset < 0) continue;
      const double* x = pool.Data(k);
      const double* h = diagonal.data() + offset;
      for (int i = 0; i < dim; ++i)
        sum += h[i] * (i < plain ? x[i] * x[i] : 1.0);
    }
  }
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  return 0.5 * kEpsilon * kEpsilon * sum;
}

}  // namespace

void RelativeRules::Start(double, const NormalEquations& equations) {
  initial_gradient_ = ScaledGradient(equations);
}

bool RelativeRules::GradientConverged(const NormalEquations& equations) const {
  if (options_.gradient_tolerance == 0.0 && initial_gradient_ > 0.0) return false;
  return ScaledGradient(equations) <= options_.gradient_tolerance * initial_gradient_;
}

// 2 predicted = dx'(H + 2 lambda D)dx: the step's own length, in the metric of the system it
// solves. |x| would be the wrong thing to hold it against: it is large far from the origin, or
// where one variable is.
bool RelativeRules::StepConverged(double, double predicted, double cost) const {
  const double tolerance = options_.step_tolerance;
  return tolerance > 0.0 && (std::abs(predicted) <= tolerance * tolerance * cost ||
                             std::abs(predicted) <= RoundingCost(graph_, w_));
}

bool RelativeRules::CostConverged(double decrease, double cost) const {
  return options_.cost_tolerance > 0.0 &&
         std::abs(decrease) <= options_.cost_tolerance * (cost + decrease);
}

bool RelativeRules::PromiseConverged(double predicted, double cost) const {
  return options_.cost_tolerance > 0.0 && std::abs(predicted) <= options_.cost_tolerance * cost;
}

bool CourseRules::CostConverged(double, double cost) const {
  return std::sqrt(2.0 * cost) <= 1e-6 * 2.0 * initial_cost_;
}

}  // namespace glissade
