// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/course.h"

namespace glissade::app {

SolveOptions CourseLm() {
  SolveOptions options;
  options.damping = Damping::kPoseBlock;
  options.initial_lambda = 1e-5;
  options.cost_tolerance = 0.0;
  options.gradient_tolerance = 0.0;
  options.step_tolerance = 1e-10;
  return options;
}

Result<CourseScene> LoadScene(const std::string& path) {
  return path.empty() ? Result<CourseScene>(MakeCourseScene()) : ReadCourseScene(path);
}

Status SetLinearSolver(const std::string& name, SolveOptions* options) {
  if (name == "dense") {
    options->linear_solver_type = LinearSolverType::kDenseCholesky;
  } else if (name == "pcg") {
    options->linear_solver_type = LinearSolverType::kPcg;
  } else {
    return {StatusCode::kInvalidArgument, "--linear-solver: must be dense or pcg, not " + name};
  }
  return {};
}

}  // namespace glissade::app
