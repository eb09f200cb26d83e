// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Solves the sliding windows of a VIOWIN file, one after the other, and says how long it took.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/count_allocations.h"
#include "common/interrupt.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/solver_options.h"
#include "common/version.h"
#include "glissade/eval/statistics.h"
#include "glissade/io/viowin.h"
#include "glissade/linear/instruction_set.h"
#include "glissade/problem/problem.h"

namespace {

using namespace glissade;
using eval::Quantile;
using Clock = std::chrono::steady_clock;

constexpr const char* kName = "window_solve";

constexpr const char* kDescription =
    R"(Solves every sliding window of a VIOWIN file from its start: keyframes, inverse depths, priors,
and, with --imu, speeds, biases, IMU terms and marginal priors.)";

constexpr const char* kFooter =
    R"(FILE is VIOWIN 1 or 2, text or compressed with gzip or bzip2. The cost is 1/2 sum rho(|r|^2), r in
sigmas. Of Levenberg-Marquardt: lambda from 1e-4 on, and a step is accepted where the cost falls by
more than 1e-3 of what was promised, as in Ceres.

Times, in ms: of all solves of all windows. 'build' is everything up to the first linearization: the
graph from the file's numbers, and the analysis of its structure, which later solves keep. The split
is the median over windows. Allocations are those of the second and later solves of a window.

Examples:
  window_solve data/win10.txt.gz                       8 steps of Levenberg-Marquardt each
  window_solve data/win10.txt.gz --imu --json result.json
  window_solve win50.txt.gz --method dogleg --iterations 50 --tolerance 1e-9
  window_solve data/win10.txt.gz --repeat 100 --threads 2
  window_solve data/win10.txt.gz --output solved.txt.gz --json - | jq .mean_final_cost

Ctrl-C ends the solve at hand: all figures are those of the windows until then, and in --output the
windows behind it are as they were.

Exit code: 0 where all windows were solved, converged or not; 130 after Ctrl-C; 2 where the file or
an option makes no sense.)";

struct Options {
  std::string file;
  bool imu = false;
  app::SolverOptions solver;
  int repeat = 3;
  std::string output;
  std::string json;

  Options() {
    solver.solve.max_iterations = 8;
    solver.solve.min_lambda = 1e-16;
    solver.solve.min_relative_decrease = 1e-3;
    solver.solve.cost_tolerance = 0.0;
    solver.solve.gradient_tolerance = 0.0;
    solver.solve.step_tolerance = 0.0;
  }
};

void AddOptions(app::Program& program, Options& o) {
  CLI::App& cli = program.cli();
  cli.add_option("FILE", o.file, "VIOWIN file: .txt, .txt.gz, .txt.bz2")->required();
  cli.add_flag("--imu", o.imu, "The visual-inertial problem (default: vision only)");
  app::AddMethod(cli, &o.solver);
  app::AddLinearSolver(cli, &o.solver);
  app::AddLoss(cli, &o.solver, "sigmas");
  app::AddGauge(cli, &o.solver);
  app::AddIterations(cli, &o.solver);
  app::AddTolerance(cli, &o.solver);
  app::AddThreads(cli, &o.solver);
  app::AddInteger(cli, "--repeat", &o.repeat, 1, 1000000, "Solve each window N times (default 3)");
  program.AddOutputFile("--output", &o.output,
                        "Write the solved windows to FILE, .gz and .bz2 compressed");
  program.AddJson(&o.json);
}

double Median(const std::vector<double>& values) {
  return Quantile(values, 0.5);
}

/// Milliseconds, one number per window (per solve in `solve`).
struct Figures {
  std::vector<double> solve, build, linearize, eliminate, linear_solve, cost;
  std::vector<double> initial_costs, final_costs;
  long long allocations = 0, repeat_solves = 0, accepted_steps = 0, rejected_steps = 0;
};

/// The states of the graph, in place of those that the window had.
void TakeStates(const Problem& problem, const WindowHandles& handles, ViowinWindow* window) {
  for (std::size_t k = 0; k < handles.poses.size(); ++k)
    window->keyframes[k].T_w_b = problem.Get(handles.poses[k]).pose;
  for (std::size_t k = 0; k < handles.speed_biases.size(); ++k)
    window->keyframes[k].speed_bias = problem.Get(handles.speed_biases[k]);
  for (std::size_t k = 0; k < handles.depths.size(); ++k)
    window->landmarks[k].rho = problem.Get(handles.depths[k]).rho;
}

/// Solves the window as often as asked, and leaves the result of the first solve in it.
Status SolveWindow(const Options& o, ViowinWindow* window, Figures* figures) {
  const auto start = Clock::now();
  Problem problem;
  const auto handles =
      AddToGraph(*window, o.imu ? WindowKind::kVisualInertial : WindowKind::kVision,
                 {.loss = o.solver.loss}, &problem);
  if (!handles.ok()) return handles.status();
  SolveOptions solve = o.solver.Chosen();
  if (!handles->poses.empty()) solve.gauge = o.solver.GaugeAt(handles->poses[0]);
  const std::chrono::duration<double, std::milli> graph = Clock::now() - start;

  const Snapshot begin = problem.GetSnapshot();
  std::vector<double> linearize, eliminate, linear_solve, cost;
  for (int k = 0; k < o.repeat && (k == 0 || !app::Interrupted()); ++k) {
    if (k > 0) {
      if (Status s = problem.RestoreSnapshot(begin); !s.ok()) return s;
    }
    const long long allocations = app::num_allocations.load();
    const SolveSummary& summary = problem.Solve(solve);
    if (!summary.ok()) return summary.status;
    if (k > 0 && summary.termination == Termination::kCancelled) break;
    if (k > 0) {
      figures->allocations += app::num_allocations.load() - allocations;
      ++figures->repeat_solves;
    } else {
      TakeStates(problem, *handles, window);
      figures->build.push_back(graph.count() + 1e3 * summary.time.analyze_s);
      figures->initial_costs.push_back(summary.initial_cost);
      figures->final_costs.push_back(summary.final_cost);
      figures->accepted_steps += summary.accepted_steps;
      figures->rejected_steps += summary.rejected_steps;
    }
    figures->solve.push_back(1e3 * (summary.time.total_s - summary.time.analyze_s));
    linearize.push_back(1e3 * summary.time.linearize_s);
    eliminate.push_back(1e3 * summary.time.eliminate_s);
    linear_solve.push_back(1e3 * summary.time.solve_s);
    cost.push_back(1e3 * summary.time.cost_s);
  }
  figures->linearize.push_back(Median(linearize));
  figures->eliminate.push_back(Median(eliminate));
  figures->linear_solve.push_back(Median(linear_solve));
  figures->cost.push_back(Median(cost));
  return {};
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double x : values)
    sum += x;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

nlohmann::ordered_json ToJson(const Options& o, std::size_t windows_in_file, const Figures& f) {
  nlohmann::ordered_json allocations = nullptr;
  if (app::kCanCountAllocations && f.repeat_solves > 0) {
    allocations = static_cast<double>(f.allocations) / static_cast<double>(f.repeat_solves);
  }
  nlohmann::ordered_json json = app::JsonHeader(kName, o.file);
  json.update({{"windows_in_file", windows_in_file},
               {"windows", f.final_costs.size()},
               {"imu", o.imu},
               {"method", o.solver.method},
               {"linear_solver", o.solver.linear_solver},
               {"threads", o.solver.solve.num_threads},
               {"median_ms", Median(f.solve)},
               {"min_ms", Quantile(f.solve, 0.0)},
               {"p95_ms", Quantile(f.solve, 0.95)},
               {"p99_ms", Quantile(f.solve, 0.99)},
               {"max_ms", Quantile(f.solve, 1.0)},
               {"build_ms", Median(f.build)},
               {"linearize_ms", Median(f.linearize)},
               {"eliminate_ms", Median(f.eliminate)},
               {"solve_ms", Median(f.linear_solve)},
               {"cost_ms", Median(f.cost)},
               {"allocations_per_solve", allocations},
               {"accepted_steps", f.accepted_steps},
               {"rejected_steps", f.rejected_steps},
               {"mean_initial_cost", Mean(f.initial_costs)},
               {"mean_final_cost", Mean(f.final_costs)},
               {"costs", f.final_costs}});
  return json;
}

app::Outcome Run(const Options& o) {
  auto windows = ReadViowin(o.file);
  if (!windows.ok()) return app::BadInput(windows.status());
  Figures figures;
  for (ViowinWindow& window : *windows) {
    if (Status s = SolveWindow(o, &window, &figures); !s.ok()) {
      return app::BadInput(fmt::format("{}: window {}: {}", o.file, window.id, s.message()));
    }
    if (app::Interrupted()) break;
  }
  app::Print("{:>8} {:>18} {:>18}\n", "window", "initial cost", "final cost");
  for (std::size_t k = 0; k < figures.final_costs.size(); ++k) {
    app::Print("{:>8} {:>18.10g} {:>18.10g}\n", (*windows)[k].id, figures.initial_costs[k],
               figures.final_costs[k]);
  }
  const nlohmann::ordered_json json = ToJson(o, windows->size(), figures);
  const auto ms = [&](const char* key) { return json[key].get<double>(); };
  app::Print("{} windows, {} solves each, {} steps accepted, {} rejected, mean cost {:.10g}\n",
             figures.final_costs.size(), o.repeat, figures.accepted_steps, figures.rejected_steps,
             ms("mean_final_cost"));
  app::Print("solve [ms]: median {:.4f}, min {:.4f}, p95 {:.4f}, p99 {:.4f}, max {:.4f} ({})\n",
             ms("median_ms"), ms("min_ms"), ms("p95_ms"), ms("p99_ms"), ms("max_ms"),
             InstructionSetName());
  app::Print(
      "split [ms]: build {:.4f}; linearize {:.4f}, eliminate {:.4f}, solve {:.4f}, cost "
      "{:.4f}\n",
      ms("build_ms"), ms("linearize_ms"), ms("eliminate_ms"), ms("solve_ms"), ms("cost_ms"));
  if (!json["allocations_per_solve"].is_null()) {
    app::Print("allocations per repeated solve: {:g}\n", ms("allocations_per_solve"));
  }
  Status written;
  if (!o.output.empty()) written = WriteViowin(*windows, o.output);
  if (written.ok() && !o.json.empty()) written = app::WriteJson(o.json, json, 2);
  return written.ok() ? app::Outcome{} : app::Failed(written);
}

}  // namespace

int main(int argc, char** argv) {
  return app::Program(kName, kDescription, kFooter).Main<Options>(argc, argv, AddOptions, Run);
}
