// requires: ceres
// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Bundle adjustment files ("Bundle Adjustment in the Large") in Ceres and in glissade, in turn, in
// one process, one thread each:
//   bench_ba [--rounds N] [--steps N] FILE...   CPU time of an accepted step, medians
//   bench_ba --once [--steps N] FILE            glissade alone: for callgrind, perf
// Ceres runs in each of the configurations that could be its fastest, with analytic Jacobians and a
// cost function of fixed sizes. GLISSADE_ISA=baseline|avx2|avx512 chooses glissade's kernels.
#include <ceres/ceres.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "glissade/io/bal.h"
#include "glissade/linear/instruction_set.h"
#include "glissade/problem/problem.h"
#include "timing.h"

namespace {

using namespace glissade;
using bench::Median;
using bench::ThreadSeconds;

/// As somebody who knows Ceres writes it: EdgeBal's derivatives, row-major as Ceres has them.
class BalCost final : public ceres::SizedCostFunction<2, 9, 3> {
 public:
  BalCost(double u, double v) : u_(u), v_(v) {}

  bool Evaluate(double const* const* x, double* r, double** J) const override {
    using Eigen::Map;
    using Eigen::Matrix;
    using Eigen::Vector3d;
    const double* c = x[0];
    const Map<const Vector3d> w(c), X(x[1]);
    const double angle2 = w.squaredNorm();
    const double angle = std::sqrt(angle2);
    // Exp(w) and its left Jacobian.
    const double a = angle2 > 1e-16 ? std::sin(angle) / angle : 1.0;
    const double b = angle2 > 1e-16 ? (1.0 - std::cos(angle)) / angle2 : 0.5;
    const double d = angle2 > 1e-16 ? (1.0 - a) / angle2 : 1.0 / 6.0;
    const Eigen::Matrix3d hat = Skew(w), hat2 = hat * hat;
    const Eigen::Matrix3d R = Eigen::Matrix3d::Identity() + a * hat + b * hat2;
    const Vector3d rotated = R * X;
    const Vector3d P = rotated + Map<const Vector3d>(c + 3);
    const double inverse = -1.0 / P[2];
    const double p[2] = {inverse * P[0], inverse * P[1]};
    const double n = p[0] * p[0] + p[1] * p[1];
    const double f = c[6], k1 = c[7], k2 = c[8];
    const double distortion = 1.0 + n * (k1 + k2 * n);
    r[0] = f * distortion * p[0] - u_;
    r[1] = f * distortion * p[1] - v_;
    if (J == nullptr) return true;
    const double slope = 2.0 * (k1 + 2.0 * k2 * n);
    const double off = f * slope * p[0] * p[1];
    const double dxx = f * (distortion + slope * p[0] * p[0]);
    const double dyy = f * (distortion + slope * p[1] * p[1]);
    Matrix<double, 2, 3> d_P;
    d_P << dxx, off, dxx * p[0] + off * p[1], off, dyy, off * p[0] + dyy * p[1];
    d_P *= inverse;
    if (J[0] != nullptr) {
      Map<Matrix<double, 2, 9, Eigen::RowMajor>> d_c(J[0]);
      const Eigen::Matrix3d Jl = Eigen::Matrix3d::Identity() + b * hat + d * hat2;
      d_c.leftCols<3>().noalias() = -(d_P * Skew(rotated)) * Jl;
      d_c.middleCols<3>(3) = d_P;
      for (int k = 0; k < 2; ++k) {
        d_c(k, 6) = distortion * p[k];
        d_c(k, 7) = f * n * p[k];
        d_c(k, 8) = f * n * n * p[k];
      }
    }
    if (J[1] != nullptr) Map<Matrix<double, 2, 3, Eigen::RowMajor>>(J[1]).noalias() = d_P * R;
    return true;
  }

 private:
  static Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
    return m;
  }
  double u_, v_;
};

struct Run {
  std::vector<double> ms;  // of each accepted step but the first
  double cost = NAN;
};

struct CeresConfiguration {
  const char* name;
  ceres::LinearSolverType solver;
  ceres::PreconditionerType preconditioner;
  bool lapack;
  bool explicit_schur;
};
constexpr CeresConfiguration kConfigurations[] = {
    {"DENSE_SCHUR, Eigen", ceres::DENSE_SCHUR, ceres::JACOBI, false, false},
    {"DENSE_SCHUR, LAPACK", ceres::DENSE_SCHUR, ceres::JACOBI, true, false},
    {"SPARSE_SCHUR, SuiteSparse", ceres::SPARSE_SCHUR, ceres::JACOBI, false, false},
    {"ITERATIVE_SCHUR, Schur-Jacobi", ceres::ITERATIVE_SCHUR, ceres::SCHUR_JACOBI, false, false},
    {"ITERATIVE_SCHUR, explicit S", ceres::ITERATIVE_SCHUR, ceres::SCHUR_JACOBI, false, true},
};

class StepTimer final : public ceres::IterationCallback {
 public:
  explicit StepTimer(Run* run) : run_(run) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& it) override {
    const double now = ThreadSeconds();
    if (it.iteration > 1 && it.step_is_successful) run_->ms.push_back(1e3 * (now - last_));
    last_ = now;
    return ceres::SOLVER_CONTINUE;
  }

 private:
  Run* run_;
  double last_ = 0.0;
};

Run SolveCeres(const BalProblem& file, const CeresConfiguration& configuration, int steps) {
  std::vector<VertexCameraBal> cameras = file.cameras;
  std::vector<VertexPointXYZ> points = file.points;
  ceres::Problem::Options problem_options;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  ceres::Solver::Options options;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (const BalObservation& seen : file.observations) {
    double* const camera = cameras[static_cast<std::size_t>(seen.camera)].data;
    double* const point = points[static_cast<std::size_t>(seen.point)].data;
    problem.AddResidualBlock(new BalCost(seen.u, seen.v), nullptr, camera, point);
    options.linear_solver_ordering->AddElementToGroup(point, 0);
    options.linear_solver_ordering->AddElementToGroup(camera, 1);
  }
  options.linear_solver_type = configuration.solver;
  options.preconditioner_type = configuration.preconditioner;
  options.use_explicit_schur_complement = configuration.explicit_schur;
  options.dense_linear_algebra_library_type = configuration.lapack ? ceres::LAPACK : ceres::EIGEN;
  options.max_num_iterations = steps;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 0.0;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = false;
  Run run;
  StepTimer timer(&run);
  options.callbacks.push_back(&timer);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  run.cost = summary.final_cost;
  return run;
}

Run SolveGlissade(const BalProblem& file, int steps) {
  Problem problem;
  Run run;
  if (const auto handles = AddToGraph(file, problem); !handles.ok()) {
    std::fprintf(stderr, "bench_ba: %s\n", handles.status().message().c_str());
    std::exit(1);
  }
  SolveOptions options;
  options.max_iterations = steps;
  options.cost_tolerance = options.gradient_tolerance = options.step_tolerance = 0.0;
  double last = 0.0;
  options.callback = [&](const IterationSummary& it) {
    const double now = ThreadSeconds();
    if (it.iteration > 1 && it.accepted) run.ms.push_back(1e3 * (now - last));
    last = now;
    return CallbackAction::kContinue;
  };
  const SolveSummary& summary = problem.Solve(options);
  if (!summary.ok()) std::fprintf(stderr, "glissade: %s\n", summary.status.message().c_str());
  run.cost = summary.final_cost;
  return run;
}

void Compare(const std::string& path, const BalProblem& file, int rounds, int steps) {
  std::printf("%s: %zu cameras, %zu points, %zu observations; glissade's kernels: %s\n",
              path.c_str(), file.cameras.size(), file.points.size(), file.observations.size(),
              InstructionSetName());
  constexpr std::size_t kCount = std::size(kConfigurations);
  std::vector<double> ours, theirs[kCount], ratio[kCount];
  double our_cost = NAN, their_cost[kCount];
  for (int round = 0; round < rounds; ++round) {
    std::fprintf(stderr, "round %d of %d\r", round + 1, rounds);
    for (std::size_t k = 0; k < kCount; ++k) {
      const Run a = SolveCeres(file, kConfigurations[k], steps);
      const Run b = SolveGlissade(file, steps);
      their_cost[k] = a.cost;
      our_cost = b.cost;
      ours.push_back(Median(b.ms));
      theirs[k].push_back(Median(a.ms));
      ratio[k].push_back(theirs[k].back() / ours.back());
    }
  }
  std::printf("  %-32s %8s %8s   %s\n", "", "ms/step", "ratio", "cost");
  std::printf("  %-32s %8.2f %8s   %.8e\n", "glissade", Median(ours), "", our_cost);
  for (std::size_t k = 0; k < kCount; ++k) {
    std::printf("  %-32s %8.2f %8.2f   %.8e\n", kConfigurations[k].name, Median(theirs[k]),
                Median(ratio[k]), their_cost[k]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 5, steps = 10;
  bool once = false;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (a == "--once") {
      once = true;
    } else if (a == "--rounds" && i + 1 < argc) {
      rounds = std::atoi(argv[++i]);
    } else if (a == "--steps" && i + 1 < argc) {
      steps = std::atoi(argv[++i]);
    } else {
      files.push_back(a);
    }
  }
  if (files.empty()) {
    std::fprintf(stderr, "bench_ba [--once] [--rounds N] [--steps N] FILE...\n");
    return 2;
  }
  for (const std::string& path : files) {
    const auto file = ReadBal(path);
    if (!file.ok()) {
      std::fprintf(stderr, "bench_ba: %s\n", file.status().message().c_str());
      return 2;
    }
    if (once) {
      const Run run = SolveGlissade(*file, steps);
      std::printf("%s: %.2f ms/step, cost %.8e\n", path.c_str(), Median(run.ms), run.cost);
    } else {
      Compare(path, *file, rounds, steps);
    }
  }
  return 0;
}
