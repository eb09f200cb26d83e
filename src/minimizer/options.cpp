// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/minimizer/options.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>

namespace glissade {

namespace {

template <class E>
bool IsOneOf(E value, std::initializer_list<E> all) {
  return std::find(all.begin(), all.end(), value) != all.end();
}

}  // namespace

Status SolveOptions::Validate() const {
  const auto refuse = [](const char* what) {
    return Status(StatusCode::kInvalidArgument, std::string("SolveOptions: ") + what);
  };
  // Written so that NaN fails each test.
  const auto non_negative = [](double x) { return x >= 0.0 && std::isfinite(x); };
  if (!IsOneOf(method, {Method::kLevenbergMarquardt, Method::kDogleg})) {
    return refuse("method is no Method");
  }
  if (!IsOneOf(damping, {Damping::kDiagonal, Damping::kIdentity, Damping::kPoseBlock})) {
    return refuse("damping is no Damping");
  }
  if (!IsOneOf(linear_solver_type, {LinearSolverType::kAuto, LinearSolverType::kDenseCholesky,
                                    LinearSolverType::kSparseCholesky, LinearSolverType::kPcg,
                                    LinearSolverType::kImplicitPcg})) {
    return refuse("linear_solver_type is no LinearSolverType");
  }
  if (!IsOneOf(pcg.preconditioner,
               {Preconditioner::kJacobi, Preconditioner::kBlockJacobi,
                Preconditioner::kClusterJacobi, Preconditioner::kPowerSeries})) {
    return refuse("pcg.preconditioner is no Preconditioner");
  }
  if (max_iterations < 0) return refuse("max_iterations must not be negative");
  if (!(max_time_s >= 0.0)) return refuse("max_time_s must not be negative");
  if (!non_negative(cost_tolerance)) return refuse("cost_tolerance must not be negative");
  if (!non_negative(gradient_tolerance)) return refuse("gradient_tolerance must not be negative");
  if (!non_negative(step_tolerance)) return refuse("step_tolerance must not be negative");
  if (!(min_relative_decrease >= 0.0 && min_relative_decrease < 1.0)) {
    return refuse("min_relative_decrease must be in [0, 1)");
  }
  if (!(initial_radius > 0.0)) return refuse("initial_radius must be positive");
  if (method == Method::kDogleg && damping == Damping::kPoseBlock) {
    return refuse("kPoseBlock is a damping of Levenberg-Marquardt, not of the dogleg");
  }
  if (!non_negative(initial_lambda)) return refuse("initial_lambda must not be negative");
  if (!non_negative(min_lambda)) return refuse("min_lambda must not be negative");
  if (!(max_lambda > 0.0)) return refuse("max_lambda must be positive");
  if (!(min_diagonal > 0.0) || !(max_diagonal >= min_diagonal)) {
    return refuse("0 < min_diagonal <= max_diagonal is needed");
  }
  if (!non_negative(pcg.tolerance)) return refuse("pcg.tolerance must not be negative");
  if (!(pcg.forcing >= 0.0 && pcg.forcing < 1.0)) return refuse("pcg.forcing must be in [0, 1)");
  if (memory_limit < 0) return refuse("memory_limit must not be negative");
  if (pcg.max_iterations < 0) return refuse("pcg.max_iterations must not be negative");
  if (num_threads < 1 || num_threads > 1024) return refuse("num_threads must be 1 to 1024");
  return {};
}

}  // namespace glissade
