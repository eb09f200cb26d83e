// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/solvers.h"

#ifdef GLISSADE_HAVE_CERES
#include <ceres/ceres.h>

#include <cstdio>
#include <memory>
#include <utility>

#include "ba/bal_cost.h"
#endif

namespace glissade::bench {

#ifdef GLISSADE_HAVE_CERES

namespace {

struct Configuration {
  const char* name;
  const char* about;
  ceres::LinearSolverType solver;
  ceres::PreconditionerType preconditioner = ceres::JACOBI;
  ceres::VisibilityClusteringType clustering = ceres::CANONICAL_VIEWS;
  bool lapack = false;
  bool explicit_schur = false;
  int max_cameras = 1 << 30;
};

constexpr Configuration kConfigurations[] = {
    {.name = "ceres-dense",
     .about = "DENSE_SCHUR, EIGEN",
     .solver = ceres::DENSE_SCHUR,
     .max_cameras = 300},
    {.name = "ceres-dense-lapack",
     .about = "DENSE_SCHUR, LAPACK",
     .solver = ceres::DENSE_SCHUR,
     .lapack = true,
     .max_cameras = 300},
    {.name = "ceres-sparse", .about = "SPARSE_SCHUR, SUITE_SPARSE", .solver = ceres::SPARSE_SCHUR},
    {.name = "ceres-iterative",
     .about = "ITERATIVE_SCHUR, SCHUR_JACOBI",
     .solver = ceres::ITERATIVE_SCHUR,
     .preconditioner = ceres::SCHUR_JACOBI},
    {.name = "ceres-iterative-explicit",
     .about = "the same, use_explicit_schur_complement",
     .solver = ceres::ITERATIVE_SCHUR,
     .preconditioner = ceres::SCHUR_JACOBI,
     .explicit_schur = true},
    {.name = "ceres-iterative-cluster",
     .about = "ITERATIVE_SCHUR, CLUSTER_JACOBI, SINGLE_LINKAGE",
     .solver = ceres::ITERATIVE_SCHUR,
     .preconditioner = ceres::CLUSTER_JACOBI,
     .clustering = ceres::SINGLE_LINKAGE},
};

class Teller final : public ceres::IterationCallback {
 public:
  Teller(Recorder* recorder, bool iterative) : recorder_(recorder), iterative_(iterative) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& it) override {
    // cost is that of the step that was tried; a rejected one is undone.
    if (it.step_is_successful) cost_ = it.cost;
    // Of a direct solver Ceres says 1.
    recorder_->Step(cost_, it.step_is_successful, iterative_ ? it.linear_solver_iterations : 0);
    return ceres::SOLVER_CONTINUE;
  }

 private:
  Recorder* recorder_;
  bool iterative_;
  double cost_ = 0.0;
};

ceres::Solver::Options OptionsOf(const Configuration& c, const Settings& settings) {
  ceres::Solver::Options options;
  options.linear_solver_type = c.solver;
  options.preconditioner_type = c.preconditioner;
  options.visibility_clustering_type = c.clustering;
  options.use_explicit_schur_complement = c.explicit_schur;
  options.dense_linear_algebra_library_type = c.lapack ? ceres::LAPACK : ceres::EIGEN;
  options.eta = settings.eta;
  options.max_num_iterations = settings.steps;
  options.max_solver_time_in_seconds = settings.time_limit_s;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 0.0;
  options.num_threads = settings.threads;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = false;
  return options;
}

Result<BalProblem> Solve(const Configuration& configuration, BalProblem file,
                         const Settings& settings, Recorder* recorder) {
  ceres::Problem::Options problem_options;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  ceres::Solver::Options options = OptionsOf(configuration, settings);
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (const BalObservation& seen : file.observations) {
    problem.AddResidualBlock(new BalCost(seen.u, seen.v), nullptr,
                             file.cameras[static_cast<std::size_t>(seen.camera)].data,
                             file.points[static_cast<std::size_t>(seen.point)].data);
  }
  file.observations = {};
  for (VertexPointXYZ& point : file.points) {
    options.linear_solver_ordering->AddElementToGroup(point.data, 0);
  }
  for (VertexCameraBal& camera : file.cameras) {
    options.linear_solver_ordering->AddElementToGroup(camera.data, 1);
  }
  Teller teller(recorder, configuration.solver == ceres::ITERATIVE_SCHUR);
  options.callbacks.push_back(&teller);
  ceres::Solver::Summary summary;
  recorder->SolveBegins();
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    return Status(StatusCode::kEvaluationFailed, "Ceres: " + summary.message);
  }
  recorder->SolveEnds(summary.final_cost,
                      ceres::LinearSolverTypeToString(summary.linear_solver_type_used));
  if (summary.message.find("Maximum solver time") != std::string::npos) {
    recorder->Fails("time limit");
  }
  return file;
}

}  // namespace

std::vector<Solver> CeresSolvers() {
  std::vector<Solver> solvers;
  for (const Configuration& c : kConfigurations) {
    solvers.push_back({c.name, c.about, c.max_cameras, true,
                       [&c](BalProblem problem, const Settings& settings, Recorder* recorder) {
                         return Solve(c, std::move(problem), settings, recorder);
                       }});
  }
  return solvers;
}

std::string CeresVersion() {
  return CERES_VERSION_STRING;
}

#else

std::vector<Solver> CeresSolvers() {
  return {};
}

std::string CeresVersion() {
  return {};
}

#endif

}  // namespace glissade::bench
