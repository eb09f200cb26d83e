// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Solves a "Bundle Adjustment in the Large" file.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/interrupt.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/solver_options.h"
#include "common/version.h"
#include "glissade/io/bal.h"
#include "glissade/problem/problem.h"
#include "studies/ceres.h"

namespace {

using namespace glissade;

constexpr const char* kName = "ba_solve";

constexpr const char* kDescription =
    R"(Solves a bundle adjustment problem of the "Bundle Adjustment in the Large" collection
(grail.cs.washington.edu/projects/bal): cameras with 9 parameters each (rotation,
translation, focal length, two of distortion), points, and where the cameras saw them.)";

constexpr const char* kFooter =
    R"(FILE is text, or compressed with gzip or bzip2. The cost is 1/2 sum rho(|r|^2), r in pixels.

Columns of the table, one line per step (x: rejected):
  cost, change   after the step; by how much it fell
  gradient       largest component
  step           length of the step
  gain           decrease of the cost over what the linear model promised
  lambda         damping for the next step
  lin            iterations of the linear solver (pcg)

Examples:
  ba_solve problem-49-7776-pre.txt.gz
  ba_solve problem.txt --loss huber:2 --output solved.txt.gz
  ba_solve data/ring.txt.gz --iterations 20 --tolerance 0     exactly 20 steps
  ba_solve problem.txt --linear-solver pcg --threads 4 --json result.json
  ba_solve problem.txt --compare-ceres                   the same with Ceres, side by side

Ctrl-C ends the solve: the best solution so far is written like any other.

Exit code: 0 where a solution was found, converged or not; 130 after Ctrl-C; 2 where the file or an
option makes no sense.)";

struct Options {
  std::string file;
  app::SolverOptions solver;
  std::string output;
  std::string json;
  bool compare_ceres = false;
};

void AddOptions(app::Program& program, Options& o) {
  CLI::App& cli = program.cli();
  cli.add_option("FILE", o.file, "BAL problem: .txt, .txt.gz, .txt.bz2")->required();
  app::AddMethod(cli, &o.solver);
  app::AddLinearSolver(cli, &o.solver);
  app::AddLoss(cli, &o.solver, "px");
  app::AddIterations(cli, &o.solver);
  app::AddTolerance(cli, &o.solver);
  app::AddThreads(cli, &o.solver);
  program.AddOutputFile("--output", &o.output,
                        "Write the solution to FILE, .gz and .bz2 compressed");
  program.AddOutput("--json", &o.json, "Write the figures of the solve to FILE");
  cli.add_flag("--compare-ceres", o.compare_ceres, "Solve with Ceres too, under the same limits");
}

/// Why a solve failed, in the words of the file.
std::string Failure(const SolveSummary& summary, const BalHandles& handles) {
  const Status& status = summary.status;
  if (status.code() != StatusCode::kDuplicate) return status.message();
  const auto index = [&](AnyEdge edge) {
    std::size_t k = 0;
    while (k < handles.edges.size() && AnyEdge(handles.edges[k]) != edge)
      ++k;
    return k;
  };
  return fmt::format("observations {} and {} (from 0) are of the same point by the same camera",
                     index(status.edge()), index(status.other_edge()));
}

double PeakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux counts in KiB
}

void PrintComparison(const SolveSummary& ours, const app::CeresResult& ceres) {
  app::Print("\n{:<10} {:>16} {:>16} {:>11} {:>10}  {}\n", "", "initial cost", "final cost",
             "iterations", "time [s]", "status");
  app::Print("{:<10} {:>16.9e} {:>16.9e} {:>11} {:>10.3f}  {}\n", "glissade", ours.initial_cost,
             ours.final_cost, ours.accepted_steps + ours.rejected_steps, ours.time.total_s,
             ToString(ours.termination));
  app::Print("{:<10} {:>16.9e} {:>16.9e} {:>11} {:>10.3f}  {} ({})\n", "ceres", ceres.initial_cost,
             ceres.final_cost, ceres.iterations, ceres.time_s, ceres.status, ceres.linear_solver);
}

nlohmann::ordered_json ToJson(const BalProblem& bal, const SolveSummary& summary, const Options& o,
                              double peak_rss_mb) {
  nlohmann::ordered_json json = app::JsonHeader(kName, o.file);
  json.update({{"cameras", bal.cameras.size()},
               {"points", bal.points.size()},
               {"observations", bal.observations.size()},
               {"initial_cost", summary.initial_cost},
               {"final_cost", summary.final_cost},
               {"iterations", summary.accepted_steps + summary.rejected_steps},
               {"status", ToString(summary.termination)},
               {"time_s", summary.time.total_s},
               {"peak_rss_mb", peak_rss_mb},
               {"method", o.solver.method},
               {"linear_solver", o.solver.linear_solver},
               {"threads", o.solver.solve.num_threads}});
  return json;
}

nlohmann::ordered_json ToJson(const app::CeresResult& ceres) {
  return {{"initial_cost", ceres.initial_cost},
          {"final_cost", ceres.final_cost},
          {"iterations", ceres.iterations},
          {"status", ceres.status},
          {"time_s", ceres.time_s},
          {"linear_solver", ceres.linear_solver}};
}

app::Outcome Run(const Options& o) {
  if (o.compare_ceres && !app::HaveCeres()) {
    return app::BadInput("--compare-ceres: this program was built without Ceres (2.1 or newer)");
  }
  const auto start = std::chrono::steady_clock::now();
  const auto bal = ReadBal(o.file);
  if (!bal.ok()) return app::BadInput(bal.status());
  Problem problem;
  const auto handles = AddToGraph(*bal, problem, o.solver.loss);
  if (!handles.ok()) {
    return app::BadInput(fmt::format("{}: {}", o.file, handles.status().message()));
  }
  const std::chrono::duration<double> read = std::chrono::steady_clock::now() - start;
  std::optional<Graph> for_ceres;
  if (o.compare_ceres) for_ceres = static_cast<const Graph&>(problem).Clone().value();

  // The first line of the table says that the problem could be evaluated: nothing is printed
  // before.
  app::SolverOptions solver = o.solver;
  solver.solve.callback = [&](const IterationSummary& it) {
    if (it.iteration == 0) {
      app::Print("{}: {} cameras, {} points, {} observations, read in {:.3f} s\n", o.file,
                 bal->cameras.size(), bal->points.size(), bal->observations.size(), read.count());
      app::Print("{}\n", IterationTableHeader());
    }
    app::Print("{}\n", ToString(it));
    return CallbackAction::kContinue;
  };
  const SolveOptions solve = solver.Chosen();
  const SolveSummary& summary = problem.Solve(solve);
  if (!summary.ok()) {
    return app::BadInput(fmt::format("{}: {}", o.file, Failure(summary, *handles)));
  }
  const double peak_rss_mb = PeakMemoryMb();
  app::Print("{}\n", summary.BriefReport());
  app::Print(
      "seconds: analyze {:.3f}, linearize {:.3f}, eliminate {:.3f}, solve {:.3f}, cost "
      "{:.3f}, total {:.3f}; peak memory {:.1f} MB\n",
      summary.time.analyze_s, summary.time.linearize_s, summary.time.eliminate_s,
      summary.time.solve_s, summary.time.cost_s, summary.time.total_s, peak_rss_mb);

  // Ceres may not find a solution: ours is written before it is asked.
  if (!o.output.empty()) {
    const auto solved = BalFromGraph(problem);
    Status s = solved.status();
    if (s.ok()) s = WriteBal(*solved, o.output);
    if (!s.ok()) return app::Failed(s);
  }
  nlohmann::ordered_json json = ToJson(*bal, summary, o, peak_rss_mb);
  Status compared;
  if (for_ceres && !app::Interrupted()) {
    const auto ceres = app::SolveWithCeres(&*for_ceres, solve);
    compared = ceres.status();
    if (ceres.ok()) {
      PrintComparison(summary, *ceres);
      json["ceres"] = ToJson(*ceres);
    }
  }
  Status written;
  if (!o.json.empty()) written = app::WriteJson(o.json, json, 2);
  for (const Status& status : {compared, written}) {
    if (!status.ok()) return app::Failed(status);
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  return app::Program(kName, kDescription, kFooter).Main<Options>(argc, argv, AddOptions, Run);
}
