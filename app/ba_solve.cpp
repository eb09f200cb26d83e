// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Solves a "Bundle Adjustment in the Large" file.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/ceres.h"
#include "common/cli.h"
#include "common/course.h"
#include "common/output_file.h"
#include "glissade/io/bal.h"
#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "glissade/losses/tukey.h"
#include "glissade/problem/problem.h"

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
  ba_solve problem.txt --loss huber --loss-width 2 --output solved.txt.gz
  ba_solve problem.txt --iterations 20 --tolerance 0     exactly 20 steps
  ba_solve problem.txt --linear-solver pcg --threads 4 --json result.json
  ba_solve problem.txt --compare-ceres                   the same with Ceres, side by side

Exit code: 0 where a solution was found, converged or not; 2 where the file or an option makes no
sense.)";

struct Options {
  std::string file;
  std::string linear_solver = "dense";
  int iterations = 50;
  int threads = 1;
  std::string loss = "none";
  double loss_width = 1.0;
  std::optional<double> tolerance;
  std::string output;
  std::string json;
  bool compare_ceres = false;
};

void AddOptions(CLI::App& app, Options& o) {
  app.add_option("FILE", o.file, "BAL problem: .txt, .txt.gz, .txt.bz2")->required();
  app.add_option(
         "--linear-solver", o.linear_solver,
         "Of the reduced camera system: 'dense' (default), a Cholesky factorization; 'pcg', "
         "conjugate gradients with block-Jacobi preconditioner")
      ->type_name("WHICH");
  app.add_option("--iterations", o.iterations, "At most N steps (default 50)")->type_name("N");
  app.add_option("--threads", o.threads, "Threads; the result is the same bits (default 1)")
      ->type_name("N");
  app.add_option("--loss", o.loss, "'none' (default), 'huber', 'cauchy' or 'tukey'")
      ->type_name("WHICH");
  app.add_option("--loss-width", o.loss_width, "Width of the loss (px; default 1)")->type_name("W");
  app.add_option(
         "--tolerance", o.tolerance,
         "Stop when the cost falls by less than T of itself (default 1e-9). 0: all stopping "
         "rules off")
      ->type_name("T");
  app.add_option("--output", o.output, "Write the solution to FILE, .gz and .bz2 compressed")
      ->type_name("FILE");
  app.add_option("--json", o.json, "Write the figures of the solve to FILE")->type_name("FILE");
  app.add_flag("--compare-ceres", o.compare_ceres, "Solve with Ceres too, under the same limits");
}

Status MakeLoss(const Options& o, Loss* loss) {
  if (o.loss == "none") {
    *loss = Loss();
  } else if (o.loss == "huber") {
    *loss = Huber{o.loss_width};
  } else if (o.loss == "cauchy") {
    *loss = Cauchy{o.loss_width};
  } else if (o.loss == "tukey") {
    *loss = Tukey{o.loss_width};
  } else {
    return {StatusCode::kInvalidArgument,
            "--loss: must be none, huber, cauchy or tukey, not " + o.loss};
  }
  if (!std::isfinite(o.loss_width) || o.loss_width <= 0.0) {
    return {StatusCode::kInvalidArgument,
            fmt::format("--loss-width: must be a finite number > 0, not {:g}", o.loss_width)};
  }
  return {};
}

Status MakeSolveOptions(const Options& o, SolveOptions* solve, Loss* loss) {
  if (Status s = app::FirstError({app::SetLinearSolver(o.linear_solver, solve), MakeLoss(o, loss),
                                  app::CheckRange("--iterations", o.iterations, 0, 1000000),
                                  app::CheckRange("--threads", o.threads, 1, 1024)});
      !s.ok()) {
    return s;
  }
  solve->max_iterations = o.iterations;
  solve->num_threads = o.threads;
  if (o.tolerance) {
    if (Status s = app::CheckAtLeast("--tolerance", *o.tolerance, 0.0); !s.ok()) return s;
    solve->cost_tolerance = *o.tolerance;
    if (*o.tolerance == 0.0) solve->gradient_tolerance = solve->step_tolerance = 0.0;
  }
  if (o.compare_ceres && !app::HaveCeres()) {
    return {StatusCode::kInvalidArgument,
            "--compare-ceres: this program was built without Ceres (2.1 or newer)"};
  }
  return app::FirstError({app::CheckDifferent("--output", o.output, "--json", o.json),
                          app::CheckWritable("--output", o.output),
                          app::CheckWritable("--json", o.json)});
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
  fmt::print("\n{:<10} {:>16} {:>16} {:>11} {:>10}  {}\n", "", "initial cost", "final cost",
             "iterations", "time [s]", "status");
  fmt::print("{:<10} {:>16.9e} {:>16.9e} {:>11} {:>10.3f}  {}\n", "glissade", ours.initial_cost,
             ours.final_cost, ours.accepted_steps + ours.rejected_steps, ours.time.total_s,
             ToString(ours.termination));
  fmt::print("{:<10} {:>16.9e} {:>16.9e} {:>11} {:>10.3f}  {} ({})\n", "ceres", ceres.initial_cost,
             ceres.final_cost, ceres.iterations, ceres.time_s, ceres.status, ceres.linear_solver);
}

nlohmann::ordered_json ToJson(const BalProblem& bal, const SolveSummary& summary, const Options& o,
                              double peak_rss_mb) {
  return {{"cameras", bal.cameras.size()},
          {"points", bal.points.size()},
          {"observations", bal.observations.size()},
          {"initial_cost", summary.initial_cost},
          {"final_cost", summary.final_cost},
          {"iterations", summary.accepted_steps + summary.rejected_steps},
          {"status", ToString(summary.termination)},
          {"time_s", summary.time.total_s},
          {"peak_rss_mb", peak_rss_mb},
          {"linear_solver", o.linear_solver},
          {"threads", o.threads}};
}

nlohmann::ordered_json ToJson(const app::CeresResult& ceres) {
  return {{"initial_cost", ceres.initial_cost},
          {"final_cost", ceres.final_cost},
          {"iterations", ceres.iterations},
          {"status", ceres.status},
          {"time_s", ceres.time_s},
          {"linear_solver", ceres.linear_solver}};
}

int Run(const Options& o) {
  SolveOptions solve;
  Loss loss;
  if (Status s = MakeSolveOptions(o, &solve, &loss); !s.ok()) {
    return app::Refuse(kName, s.message());
  }
  const auto start = std::chrono::steady_clock::now();
  const auto bal = ReadBal(o.file);
  if (!bal.ok()) return app::Refuse(kName, bal.status().message());
  Problem problem;
  const auto handles = AddToGraph(*bal, problem, loss);
  if (!handles.ok()) {
    return app::Refuse(kName, fmt::format("{}: {}", o.file, handles.status().message()));
  }
  const std::chrono::duration<double> read = std::chrono::steady_clock::now() - start;
  std::optional<Graph> for_ceres;
  if (o.compare_ceres) for_ceres = static_cast<const Graph&>(problem).Clone();

  // The first line of the table says that the problem could be evaluated: nothing is printed
  // before.
  solve.callback = [&](const IterationSummary& it) {
    if (it.iteration == 0) {
      fmt::print("{}: {} cameras, {} points, {} observations, read in {:.3f} s\n", o.file,
                 bal->cameras.size(), bal->points.size(), bal->observations.size(), read.count());
      fmt::print("{}\n", IterationTableHeader());
    }
    fmt::print("{}\n", ToString(it));
    std::fflush(stdout);
    return CallbackAction::kContinue;
  };
  const SolveSummary& summary = problem.Solve(solve);
  if (!summary.ok()) {
    return app::Refuse(kName, fmt::format("{}: {}", o.file, Failure(summary, *handles)));
  }
  const double peak_rss_mb = PeakMemoryMb();
  fmt::print("{}\n", summary.BriefReport());
  fmt::print(
      "seconds: analyze {:.3f}, linearize {:.3f}, eliminate {:.3f}, solve {:.3f}, cost "
      "{:.3f}, total {:.3f}; peak memory {:.1f} MB\n",
      summary.time.analyze_s, summary.time.linearize_s, summary.time.eliminate_s,
      summary.time.solve_s, summary.time.cost_s, summary.time.total_s, peak_rss_mb);

  nlohmann::ordered_json json = ToJson(*bal, summary, o, peak_rss_mb);
  if (for_ceres) {
    const auto ceres = app::SolveWithCeres(&*for_ceres, solve);
    if (!ceres.ok()) return app::Refuse(kName, ceres.status().message(), app::kExitFailed);
    PrintComparison(summary, *ceres);
    json["ceres"] = ToJson(*ceres);
  }
  if (!o.output.empty()) {
    const auto solved = BalFromGraph(problem);
    Status s = solved.status();
    if (s.ok()) s = WriteBal(*solved, o.output);
    if (!s.ok()) return app::Refuse(kName, s.message(), app::kExitFailed);
  }
  if (!o.json.empty()) {
    if (Status s = app::WriteFile(o.json, json.dump(2) + "\n"); !s.ok()) {
      return app::Refuse(kName, s.message(), app::kExitFailed);
    }
  }
  return app::kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli(kDescription, kName);
  cli.footer(kFooter);
  Options options;
  AddOptions(cli, options);
  if (const auto exit_code = app::Parse(cli, argc, argv)) return *exit_code;
  return Run(options);
}
