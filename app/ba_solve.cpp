// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Solves a "Bundle Adjustment in the Large" problem, a COLMAP model or a pose graph of g2o's.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "ba/problem_input.h"
#include "ba/solution_output.h"
#include "ba/solve_progress.h"
#include "common/interrupt.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/solver_options.h"
#include "common/status_line.h"
#include "common/version.h"
#include "glissade/problem/problem.h"
#include "studies/ceres.h"

namespace {

using namespace glissade;

constexpr const char* kName = "ba_solve";

constexpr const char* kDescription =
    R"(Solves a bundle adjustment problem of the "Bundle Adjustment in the Large" collection
(grail.cs.washington.edu/projects/bal): cameras with 9 parameters each (rotation,
translation, focal length, two of distortion), points, and where the cameras saw them.
Or a COLMAP model, with the cameras that its images share; or a graph of g2o's: poses, landmarks,
known cameras.)";

constexpr const char* kFooter =
    R"(FILE is text, compressed with gzip or bzip2 or not, or the binary form that is read four times as
fast (.bbal); a folder is a COLMAP model, binary or text; a file that begins with a word is one of
g2o's (docs/formats.md has its tags). --city makes a problem in memory instead: streets, houses, and
a car with cameras. The cost is 1/2 sum rho(|r|^2), r in pixels; of g2o's, in sigmas. Where a graph
of g2o's fixes no vertex and has no prior, its first pose is held.

--output ends in .ply: points, coloured by their errors, and cameras, for MeshLab and others; of a
COLMAP model, a folder for the model; else a BAL file, binary where it ends in .bbal, or where it is
a folder or ends in '/' the problem as a COLMAP model. A graph of g2o's is written as .g2o.

On a terminal a line under the table says how far a long solve is and how long it may take.

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
  ba_solve problem.txt.gz --iterations 0 --output problem.bbal     once, to read it faster
  ba_solve --city 200 --seed 7 --output city.ply
  ba_solve --city 100 --memory-limit 500M --threads 2
  ba_solve MODEL --loss huber:1 --output refined         a COLMAP model
  ba_solve data/loops.g2o.gz --output solved.g2o

Ctrl-C ends the solve: the best solution so far is written like any other.

Exit code: 0 where a solution was found, converged or not; 130 after Ctrl-C; 2 where the file or an
option makes no sense.)";

struct Options {
  app::ProblemInput input;
  app::SolverOptions solver;
  app::SolutionOutput output;
  std::string json;
  bool compare_ceres = false;
};

void AddOptions(app::Program& program, Options& o) {
  CLI::App& cli = program.cli();
  app::AddProblemInput(cli, &o.input);
  app::AddMethod(cli, &o.solver);
  app::AddLinearSolver(cli, &o.solver);
  o.solver.solve.pcg.forcing = 0.1;
  app::AddPcg(cli, &o.solver);
  app::AddMemoryLimit(cli, &o.solver);
  app::AddLoss(cli, &o.solver, "px");
  app::AddIterations(cli, &o.solver);
  app::AddTolerance(cli, &o.solver);
  app::AddThreads(cli, &o.solver);
  program.AddOutputPath(
      "--output", &o.output.path,
      "Write the solution to FILE: .txt, .gz, .bz2, .bbal, .ply, .g2o, or a folder");
  program.AddJson(&o.json);
  cli.add_flag("--compare-ceres", o.compare_ceres, "Solve with Ceres too, under the same limits");
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

nlohmann::ordered_json ToJson(const app::ProblemSize& size, const SolveSummary& summary,
                              const Options& o, double peak_rss_mb) {
  nlohmann::ordered_json json = app::JsonHeader(kName, o.input.Name());
  json.update({{"cameras", size.cameras},
               {"points", size.points},
               {"observations", size.observations},
               {"initial_cost", summary.initial_cost},
               {"final_cost", summary.final_cost},
               {"iterations", summary.accepted_steps + summary.rejected_steps},
               {"status", ToString(summary.termination)},
               {"time_ms", 1e3 * summary.time.total_s},
               {"peak_rss_mb", peak_rss_mb},
               {"method", o.solver.method},
               {"linear_solver", o.solver.linear_solver},
               {"reduced_solver", summary.reduced.name},
               {"threads", o.solver.solve.num_threads}});
  if (size.images > 0) json["images"] = size.images;
  if (size.poses > 0) json["poses"] = size.poses;
  return json;
}

nlohmann::ordered_json ToJson(const app::CeresResult& ceres) {
  return {{"initial_cost", ceres.initial_cost}, {"final_cost", ceres.final_cost},
          {"iterations", ceres.iterations},     {"status", ceres.status},
          {"time_ms", 1e3 * ceres.time_s},      {"linear_solver", ceres.linear_solver}};
}

app::Outcome Run(const Options& o) {
  if (o.compare_ceres && !app::HaveCeres()) {
    return app::BadInput("--compare-ceres: this program was built without Ceres (2.1 or newer)");
  }
  if (Status s = o.input.Validate(); !s.ok()) return app::BadInput(s);
  const auto start = std::chrono::steady_clock::now();
  app::StatusLine status;
  Problem problem;
  app::ProblemSource source;
  if (Status s = app::LoadProblem(o.input, o.solver.loss, &status, &problem, &source); !s.ok()) {
    return app::BadInput(s);
  }
  app::SolutionOutput output = o.output;
  output.colmap_text = o.input.colmap.text;
  if (Status s = app::CheckSolutionOutput(output, source); !s.ok()) return app::BadInput(s);
  const app::ProblemSize size = app::SizeOf(problem, source);
  const std::chrono::duration<double> loaded = std::chrono::steady_clock::now() - start;
  std::optional<Graph> for_ceres;
  if (o.compare_ceres) for_ceres = static_cast<const Graph&>(problem).Clone().value();

  // The first line of the table says that the problem could be evaluated: nothing is printed
  // before.
  app::SolverOptions solver = o.solver;
  app::SolveProgress progress(solver.solve);
  solver.solve.callback = [&](const IterationSummary& it) {
    status.Clear();
    if (it.iteration == 0) {
      app::Print("{}: {}, {} in {:.3f} s\n", o.input.Name(), app::ToString(size),
                 o.input.city == 0 ? "read" : "made", loaded.count());
      const std::string note = source.colmap ? app::WhatIsLeftOut(source.colmap->handles)
                               : source.g2o  ? app::WhatIsHeld(source.g2o->handles)
                                             : "";
      if (!note.empty()) app::Print("{}\n", note);
      app::Print("{}\n", IterationTableHeader());
    }
    app::Print("{}\n", ToString(it));
    status.Show(progress.After(it));
    return CallbackAction::kContinue;
  };
  const SolveOptions solve = solver.Chosen();
  status.ShowNow("preparing the solve");
  const SolveSummary& summary = problem.Solve(solve);
  status.Clear();
  if (!summary.ok()) {
    return app::BadInput(
        fmt::format("{}: {}", o.input.Name(), app::WhyNotSolved(summary, problem)));
  }
  const double peak_rss_mb = PeakMemoryMb();
  app::Print("{}\n", summary.BriefReport());
  const ReducedSolver& reduced = summary.reduced;
  app::Print("reduced system: {} scalars, {:.3g} % of its blocks, solved by {}: {}\n",
             reduced.scalars, 100.0 * reduced.density, reduced.name, reduced.reason);
  app::Print(
      "seconds: analyze {:.3f}, linearize {:.3f}, eliminate {:.3f}, solve {:.3f}, cost "
      "{:.3f}, total {:.3f}; peak memory {:.1f} MB\n",
      summary.time.analyze_s, summary.time.linearize_s, summary.time.eliminate_s,
      summary.time.solve_s, summary.time.cost_s, summary.time.total_s, peak_rss_mb);

  // Ceres may not find a solution: ours is written before it is asked.
  if (!output.path.empty()) {
    const Status s = app::WriteSolution(problem, source, output, &status);
    status.Clear();
    if (!s.ok()) return app::Failed(s);
  }
  nlohmann::ordered_json json = ToJson(size, summary, o, peak_rss_mb);
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
  for (const Status& s : {compared, written}) {
    if (!s.ok()) return app::Failed(s);
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  return app::Program(kName, kDescription, kFooter).Main<Options>(argc, argv, AddOptions, Run);
}
