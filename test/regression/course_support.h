// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "glissade/linear/linear_solver.h"
#include "glissade/minimizer/options.h"
#include "glissade/problem/problem.h"
#include "glissade/sim/course_scene.h"

namespace glissade::test {

/// As the course prints a number.
inline std::string SixDigits(double x) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", x);
  return text;
}

/// The course's Levenberg-Marquardt, with its stopping rule or run to convergence.
inline SolveOptions CourseOptions(bool course_stop) {
  SolveOptions options;
  options.damping = Damping::kPoseBlock;
  options.initial_lambda = 1e-5;
  options.course_stop = course_stop;
  options.cost_tolerance = 0.0;
  options.gradient_tolerance = 0.0;
  options.step_tolerance = 1e-10;
  options.max_iterations = 200;
  return options;
}

/// Ours, run until steps are 1e-10 of the state and by no other rule.
inline SolveOptions ConvergedOptions() {
  SolveOptions options;
  options.cost_tolerance = 0.0;
  options.gradient_tolerance = 0.0;
  options.step_tolerance = 1e-10;
  options.max_iterations = 200;
  return options;
}

/// The course scene in a Problem, solved.
struct CourseRun {
  CourseScene scene = MakeCourseScene();
  Problem problem;
  CourseHandles handles;
  SolveSummary summary;

  CourseRun(const CourseGraphOptions& graph, const SolveOptions& solve) {
    handles = AddToGraph(scene, problem, graph).value();
    summary = problem.Solve(solve);
  }

  /// Sum of Chi2 (no 1/2) at the start and after each accepted step, in six digits.
  [[nodiscard]] std::vector<std::string> Chi() const {
    std::vector<std::string> chi;
    for (const IterationSummary& it : summary.iterations) {
      if (it.accepted) chi.push_back(SixDigits(2.0 * it.cost));
    }
    return chi;
  }
  [[nodiscard]] std::vector<std::string> Lambda() const {
    std::vector<std::string> lambda;
    for (const IterationSummary& it : summary.iterations) {
      if (it.accepted) lambda.push_back(SixDigits(it.lambda));
    }
    return lambda;
  }
  [[nodiscard]] std::string Point(std::size_t k) const {
    return SixDigits(problem.Get(handles.points[k]).rho);
  }
  [[nodiscard]] std::vector<std::string> Pose(std::size_t n) const {
    const double* t = problem.Get(handles.poses[n]).Data();
    return {SixDigits(t[0]), SixDigits(t[1]), SixDigits(t[2])};
  }
  [[nodiscard]] CourseErrors Errors() const { return ErrorsOf(scene, problem, handles); }
};

/// Conjugate gradients as in the course's solver, written anew: preconditioned with the diagonal,
/// started at 0, ended at |r| <= 1e-6 |b| or after twice as many steps as unknowns.
///
/// With `drop_first_step` it has the published defect: the residual follows the first step, the
/// solution does not.
class TextbookPcg final : public LinearSolver {
 public:
  explicit TextbookPcg(bool drop_first_step) : drop_first_step_(drop_first_step) {}

  [[nodiscard]] SchurForm Form(const SchurLayout&) override { return SchurForm::kDense; }

  LinearSolverResult Prepare(const SchurOperator& S) override {
    diagonal_.resize(S.layout().size());
    const BlockView block = S.Block(0);
    for (Eigen::Index i = 0; i < diagonal_.size(); ++i)
      diagonal_[i] = block.data[i * (block.stride + 1)];
    return {.ok = true};
  }

  LinearSolverResult Solve(const SchurOperator& S, const double* b, double* solution,
                           const SolveRequest&) override {
    const int n = static_cast<int>(S.layout().size());
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXd>(b, n);
    Eigen::VectorXd Sp(n);
    Eigen::VectorXd z = r.cwiseQuotient(diagonal_);
    Eigen::VectorXd p = z;
    const double threshold = 1e-6 * r.norm();
    double rz = r.dot(z);
    LinearSolverResult result{.ok = true, .iterations = 0, .exact = false};
    while (r.norm() > threshold && result.iterations < 2 * n) {
      S.Multiply(p.data(), Sp.data());
      const double alpha = rz / p.dot(Sp);
      if (result.iterations > 0 || !drop_first_step_) x += alpha * p;
      r -= alpha * Sp;
      z = r.cwiseQuotient(diagonal_);
      const double next = r.dot(z);
      p = z + next / rz * p;
      rz = next;
      ++result.iterations;
    }
    Eigen::Map<Eigen::VectorXd>(solution, n) = x;
    result.ok = x.allFinite();
    return result;
  }

 private:
  bool drop_first_step_;
  Eigen::VectorXd diagonal_;
};

}  // namespace glissade::test
