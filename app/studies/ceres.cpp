// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/ceres.h"

#ifdef GLISSADE_HAVE_CERES
#include <ceres/solver.h>

#include "glissade/bridge/ceres.h"
#include "glissade/vertices/camera_bal.h"
#endif

namespace glissade::app {

#ifdef GLISSADE_HAVE_CERES

bool HaveCeres() {
  return true;
}

namespace {

ceres::LinearSolverType LinearSolverFor(const Graph& graph, LinearSolverType type) {
  switch (type) {
    case LinearSolverType::kDenseCholesky:
      return ceres::DENSE_SCHUR;
    case LinearSolverType::kSparseCholesky:
      return ceres::SPARSE_SCHUR;
    case LinearSolverType::kPcg:
    case LinearSolverType::kImplicitPcg:
      return ceres::ITERATIVE_SCHUR;
    case LinearSolverType::kAuto:
      break;
  }
  // "Up to a hundred or so cameras" says its manual of the dense one.
  const bool small = graph.NumVertices<VertexCameraBal>() + graph.NumVertices<VertexPose>() <= 100;
  return small ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
}

}  // namespace

Result<CeresResult> SolveWithCeres(Graph* graph, const SolveOptions& options) {
  ceres::Solver::Options ceres_options;
  ceres_options.max_num_iterations = options.max_iterations;
  ceres_options.num_threads = options.num_threads;
  ceres_options.function_tolerance = options.cost_tolerance;
  ceres_options.gradient_tolerance = 0.0;
  ceres_options.parameter_tolerance = 0.0;
  ceres_options.logging_type = ceres::SILENT;
  ceres_options.linear_solver_type = LinearSolverFor(*graph, options.linear_solver_type);
  if (ceres_options.linear_solver_type == ceres::ITERATIVE_SCHUR) {
    ceres_options.preconditioner_type = ceres::SCHUR_JACOBI;
  }

  const ceres::Solver::Summary summary = bridge::SolveWithCeres(graph, ceres_options);
  if (!summary.IsSolutionUsable()) {
    return Status(StatusCode::kEvaluationFailed, "Ceres: " + summary.message);
  }
  CeresResult result;
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  result.time_s = summary.total_time_in_seconds;
  result.status = ceres::TerminationTypeToString(summary.termination_type);
  result.linear_solver = ceres::LinearSolverTypeToString(summary.linear_solver_type_used);
  return result;
}

#else

bool HaveCeres() {
  return false;
}

Result<CeresResult> SolveWithCeres(Graph*, const SolveOptions&) {
  return Status(StatusCode::kInvalidArgument, "this program was built without Ceres");
}

#endif

}  // namespace glissade::app
