// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Every solver of the reduced system computes the same steps and reaches the same optimum, on a
// ring of cameras and in a city, with losses and with cameras that are fixed wholly or in part; and
// does so to the bit whatever the number of threads.

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "common/sanitized.h"
#include "glissade/glissade.h"
#include "glissade/io/bal.h"
#include "glissade/io/colmap_graph.h"
#include "glissade/sim/bal_scene.h"
#include "glissade/sim/city.h"
#include "support/colmap_scene.h"

namespace glissade {
namespace {

struct Solver {
  const char* name;
  LinearSolverType type;
  Preconditioner preconditioner = Preconditioner::kBlockJacobi;
  [[nodiscard]] bool iterates() const {
    return type == LinearSolverType::kPcg || type == LinearSolverType::kImplicitPcg;
  }
};
constexpr Solver kSolvers[] = {
    {"dense", LinearSolverType::kDenseCholesky},
    {"sparse", LinearSolverType::kSparseCholesky},
    {"pcg, Jacobi", LinearSolverType::kPcg, Preconditioner::kJacobi},
    {"pcg, block Jacobi", LinearSolverType::kPcg, Preconditioner::kBlockJacobi},
    {"pcg, clusters", LinearSolverType::kPcg, Preconditioner::kClusterJacobi},
    {"pcg, power series", LinearSolverType::kPcg, Preconditioner::kPowerSeries},
    {"implicit, block Jacobi", LinearSolverType::kImplicitPcg, Preconditioner::kBlockJacobi},
    {"implicit, clusters", LinearSolverType::kImplicitPcg, Preconditioner::kClusterJacobi},
    {"implicit, power series", LinearSolverType::kImplicitPcg, Preconditioner::kPowerSeries},
};

SolveOptions OptionsOf(const Solver& solver) {
  SolveOptions options;
  options.linear_solver_type = solver.type;
  options.pcg.preconditioner = solver.preconditioner;
  options.pcg.tolerance = 1e-13;
  return options;
}

/// With losses a camera is held, and of another one the focal length.
Problem MakeBalProblem(const BalProblem& bal, bool with_losses) {
  Problem problem;
  const auto handles = AddToGraph(bal, problem, with_losses ? Loss(Huber{2.0}) : Loss());
  EXPECT_TRUE(handles.ok());
  if (with_losses) {
    EXPECT_TRUE(problem.SetFixed(handles->cameras[1]).ok());
    EXPECT_TRUE(problem.SetFixedNumbers(handles->cameras[2], 1u << 6).ok());
  }
  return problem;
}

Problem MakeCityProblem(bool with_losses) {
  sim::CityOptions city;
  city.num_cameras = test::kSanitized ? 20 : 40;
  return MakeBalProblem(sim::MakeCity(city).value(), with_losses);
}

/// Images that share two cameras, whose principal points are held.
Problem MakeColmapProblem(bool with_losses) {
  test::ColmapSceneOptions scene;
  scene.cameras = {ColmapCameraModel::kSimpleRadial, ColmapCameraModel::kOpenCv};
  ColmapGraphOptions options;
  options.fix_first_image = true;
  if (with_losses) options.loss = Huber{2.0};
  Problem problem;
  EXPECT_TRUE(
      AddToGraph(test::PerturbColmapScene(test::MakeColmapScene(scene, 3), 4), problem, options)
          .ok());
  return problem;
}

std::vector<Problem> MakeProblems(bool with_losses) {
  std::vector<Problem> problems;
  problems.push_back(MakeBalProblem(sim::MakeBalScene({}).value(), with_losses));
  problems.push_back(MakeCityProblem(with_losses));
  problems.push_back(MakeColmapProblem(with_losses));
  return problems;
}

TEST(ReducedSolvers, ComputeTheSameStep) {
  for (const bool with_losses : {false, true}) {
    for (Problem& problem : MakeProblems(with_losses)) {
      ASSERT_TRUE(problem.MakeHessian().ok());
      Eigen::VectorXd reference;
      for (const Solver& solver : kSolvers) {
        const Status status = problem.SolveLinearSystem(1e-3, OptionsOf(solver));
        ASSERT_TRUE(status.ok()) << solver.name << ": " << status.message();
        const Eigen::VectorXd step = problem.Step();
        if (reference.size() == 0) reference = step;
        EXPECT_LT((step - reference).norm(), (solver.iterates() ? 1e-6 : 1e-8) * reference.norm())
            << solver.name;
      }
    }
  }
}

TEST(ReducedSolvers, ReachTheSameOptimum) {
  for (const bool with_losses : {false, true}) {
    for (const Problem& original : MakeProblems(with_losses)) {
      double reference = 0.0;
      for (const Solver& solver : kSolvers) {
        if (solver.preconditioner == Preconditioner::kJacobi) continue;  // slow
        Problem problem = original.Clone().value();
        SolveOptions options = OptionsOf(solver);
        options.pcg.tolerance = 1e-8;
        options.pcg.forcing = solver.iterates() ? 0.1 : 0.0;
        const SolveSummary& summary = problem.Solve(options);
        ASSERT_TRUE(summary.converged()) << solver.name << ": " << summary.BriefReport();
        if (reference == 0.0) reference = summary.final_cost;
        EXPECT_NEAR(summary.final_cost, reference, 1e-6 * reference) << solver.name;
      }
    }
  }
}

TEST(ReducedSolvers, ThreadsChangeNoBit) {
  const Problem original = MakeCityProblem(true);
  for (const Solver& solver : kSolvers) {
    if (solver.preconditioner == Preconditioner::kJacobi) continue;
    std::vector<double> first;
    for (const int threads : {1, 2, 4}) {
      Problem problem = original.Clone().value();
      SolveOptions options = OptionsOf(solver);
      options.max_iterations = 2;
      options.pcg.max_iterations = 20;
      options.num_threads = threads;
      ASSERT_TRUE(problem.Solve(options).ok());
      const std::vector<double> states = problem.GetSnapshot().states;
      if (first.empty()) first = states;
      ASSERT_EQ(states.size(), first.size());
      EXPECT_EQ(std::memcmp(states.data(), first.data(), states.size() * sizeof(double)), 0)
          << solver.name << ", " << threads << " threads";
    }
  }
}

// The series needs an H_pp of diagonal blocks; what shares poses is solved all the same.
TEST(ReducedSolvers, PowerSeriesWhereItNeedNotConverge) {
  Problem problem;
  std::vector<VertexHandle<VertexPose>> poses;
  for (int k = 0; k < 5; ++k)
    poses.push_back(problem.AddVertex(VertexPose{}));
  ASSERT_TRUE(problem.AddEdge(EdgeSE3Prior{}, {poses[0]}).ok());
  for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
    const EdgeRelativePose edge{Pose(Quaternion::Identity(), Vector3(1.0, 0.0, 0.0))};
    ASSERT_TRUE(problem.AddEdge(edge, {poses[k], poses[k + 1]}).ok());
  }
  SolveOptions options;
  options.linear_solver_type = LinearSolverType::kPcg;
  options.pcg.preconditioner = Preconditioner::kPowerSeries;
  const SolveSummary& summary = problem.Solve(options);
  EXPECT_TRUE(summary.converged()) << summary.BriefReport();
  EXPECT_LT(summary.final_cost, 1e-12);
}

}  // namespace
}  // namespace glissade
