// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "ba/solvers.h"
#include "glissade/problem/problem.h"

namespace glissade::bench {

namespace {

struct Configuration {
  const char* name;
  const char* about;
  LinearSolverType type;
  Preconditioner preconditioner = Preconditioner::kBlockJacobi;
  bool by_default = true;
};

using enum LinearSolverType;
constexpr Configuration kConfigurations[] = {
    {"glissade-auto", "kAuto", kAuto},
    {"glissade-dense", "kDenseCholesky", kDenseCholesky, Preconditioner::kBlockJacobi, false},
    {"glissade-sparse", "kSparseCholesky", kSparseCholesky},
    {"glissade-pcg", "kPcg, kBlockJacobi", kPcg},
    {"glissade-pcg-cluster", "kPcg, kClusterJacobi", kPcg, Preconditioner::kClusterJacobi, false},
    {"glissade-implicit", "kImplicitPcg, kBlockJacobi", kImplicitPcg},
    {"glissade-implicit-cluster", "kImplicitPcg, kClusterJacobi", kImplicitPcg,
     Preconditioner::kClusterJacobi, false},
    {"glissade-implicit-power", "kImplicitPcg, kPowerSeries", kImplicitPcg,
     Preconditioner::kPowerSeries, false},
};

Result<BalProblem> Solve(const Configuration& configuration, BalProblem file,
                         const Settings& settings, Recorder* recorder) {
  Problem problem;
  if (Status s = MoveToGraph(std::move(file), problem); !s.ok()) return s;
  SolveOptions options;
  options.linear_solver_type = configuration.type;
  options.pcg.preconditioner = configuration.preconditioner;
  options.pcg.forcing = settings.eta;
  options.max_iterations = settings.steps;
  options.max_time_s = settings.time_limit_s;
  options.num_threads = settings.threads;
  options.cost_tolerance = options.gradient_tolerance = options.step_tolerance = 0.0;
  options.callback = [&](const IterationSummary& it) {
    recorder->Step(it.cost, it.accepted, it.linear_iterations);
    return CallbackAction::kContinue;
  };
  recorder->SolveBegins();
  const SolveSummary& summary = problem.Solve(options);
  if (!summary.ok()) return summary.status;
  std::string chosen = summary.reduced.name;
  if (configuration.type == kAuto) chosen.append(": ").append(summary.reduced.reason);
  if (summary.reduced.memory_bytes > 0) {
    chosen.append("; estimated ")
        .append(std::to_string(summary.reduced.memory_bytes / 1048576))
        .append(" MB");
  }
  recorder->SolveEnds(summary.final_cost, chosen);
  if (summary.termination == Termination::kMaxTime) recorder->Fails("time limit");
  return BalFromGraph(problem);
}

}  // namespace

std::vector<Solver> GlissadeSolvers() {
  std::vector<Solver> solvers;
  for (const Configuration& c : kConfigurations) {
    solvers.push_back({c.name, c.about, c.type == kDenseCholesky ? 300 : 1 << 30, c.by_default,
                       [&c](BalProblem problem, const Settings& settings, Recorder* recorder) {
                         return Solve(c, std::move(problem), settings, recorder);
                       }});
  }
  return solvers;
}

}  // namespace glissade::bench
