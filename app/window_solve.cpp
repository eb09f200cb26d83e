// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Solves the sliding windows of a VIOWIN file, one after the other, and says how long it took.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/cli.h"
#include "common/count_allocations.h"
#include "common/output_file.h"
#include "glissade/io/viowin.h"
#include "glissade/linear/instruction_set.h"
#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "glissade/losses/tukey.h"
#include "glissade/problem/problem.h"

namespace {

using namespace glissade;
using Clock = std::chrono::steady_clock;

constexpr const char* kName = "window_solve";

constexpr const char* kDescription =
    R"(Solves every sliding window of a VIOWIN file from its start: keyframes, inverse depths, priors,
and, with --imu, speeds, biases, IMU terms and marginal priors.)";

constexpr const char* kFooter =
    R"(FILE is VIOWIN 1 or 2, text or compressed with gzip or bzip2. The cost is 1/2 sum rho(|r|^2), r in
sigmas.

Times, in ms: of all solves of all windows. 'build' is everything up to the first linearization: the
graph from the file's numbers, and the analysis of its structure, which later solves keep. The split
is the median over windows. Allocations are those of the second and later solves of a window.

Examples:
  window_solve win10.txt.gz                            8 steps of Levenberg-Marquardt each
  window_solve win10.txt.gz --imu --json result.json
  window_solve win50.txt.gz --method dogleg --iterations 50 --tolerance 1e-9
  window_solve win10.txt.gz --repeat 100 --threads 2

Exit code: 0 where all windows were solved, converged or not; 2 where the file or an option makes no
sense.)";

struct Options {
  std::string file;
  bool imu = false;
  int iterations = 8;
  std::string method = "lm";
  std::string damping = "ceres";
  std::string loss = "none";
  int threads = 1;
  int repeat = 3;
  double tolerance = 0.0;
  std::string json;
};

void AddOptions(CLI::App& app, Options& o) {
  app.add_option("FILE", o.file, "VIOWIN file: .txt, .txt.gz, .txt.bz2")->required();
  app.add_flag("--imu", o.imu, "The visual-inertial problem (default: vision only)");
  app.add_option("--iterations", o.iterations, "At most N steps (default 8)")->type_name("N");
  app.add_option("--method", o.method, "'lm' (default): Levenberg-Marquardt; 'dogleg'")
      ->type_name("WHICH");
  app.add_option("--damping", o.damping,
                 "Of lm: 'ceres' (default), lambda diag(H) from 1e-4 on; 'nielsen', lambda I from "
                 "1e-5 max diag(H) on")
      ->type_name("WHICH");
  app.add_option("--loss", o.loss,
                 "Of the observations: 'none' (default), 'huber:W', 'cauchy:W' or 'tukey:W', W the "
                 "width in sigmas")
      ->type_name("WHICH:W");
  app.add_option("--threads", o.threads, "Threads; the result is the same bits (default 1)")
      ->type_name("N");
  app.add_option("--repeat", o.repeat, "Solve each window N times (default 3)")->type_name("N");
  app.add_option("--tolerance", o.tolerance,
                 "Stop when the cost falls by less than T of itself (default 0: all stopping rules "
                 "off)")
      ->type_name("T");
  app.add_option("--json", o.json, "Write the figures to FILE")->type_name("FILE");
}

Status Invalid(std::string message) {
  return {StatusCode::kInvalidArgument, std::move(message)};
}

/// "huber:2".
Status ParseLoss(const std::string& text, Loss* loss) {
  if (text == "none") return {};
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  if (name != "huber" && name != "cauchy" && name != "tukey") {
    return Invalid("--loss: must be none, huber:W, cauchy:W or tukey:W, not " + text);
  }
  const std::string number = colon == std::string::npos ? "" : text.substr(colon + 1);
  char* end = nullptr;
  const double width = std::strtod(number.c_str(), &end);
  if (number.empty() || *end != '\0' || !std::isfinite(width) || width <= 0.0) {
    return Invalid(fmt::format("--loss: the width must be a finite number > 0, as in {}:2, not {}",
                               name, text));
  }
  if (name == "huber") *loss = Huber{width};
  if (name == "cauchy") *loss = Cauchy{width};
  if (name == "tukey") *loss = Tukey{width};
  return {};
}

Status MakeSolveOptions(const Options& o, SolveOptions* solve, Loss* loss) {
  if (o.method == "dogleg") {
    solve->method = Method::kDogleg;
  } else if (o.method != "lm") {
    return Invalid("--method: must be lm or dogleg, not " + o.method);
  }
  if (o.damping == "ceres") {
    solve->damping = Damping::kDiagonal;
    solve->initial_lambda = 1e-4;
    solve->min_lambda = 1e-16;
    solve->min_relative_decrease = 1e-3;
  } else if (o.damping == "nielsen") {
    solve->damping = Damping::kIdentity;
    solve->initial_lambda = 1e-5;
  } else {
    return Invalid("--damping: must be ceres or nielsen, not " + o.damping);
  }
  solve->max_iterations = o.iterations;
  solve->num_threads = o.threads;
  solve->cost_tolerance = o.tolerance;
  if (o.tolerance == 0.0) solve->gradient_tolerance = solve->step_tolerance = 0.0;
  return app::FirstError(
      {ParseLoss(o.loss, loss), app::CheckRange("--iterations", o.iterations, 0, 1000000),
       app::CheckRange("--threads", o.threads, 1, 1024),
       app::CheckRange("--repeat", o.repeat, 1, 1000000),
       app::CheckAtLeast("--tolerance", o.tolerance, 0.0), app::CheckWritable("--json", o.json)});
}

/// p-th part of the sorted values, interpolated.
double Quantile(std::vector<double> values, double p) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double at = p * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
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

Status SolveWindow(const ViowinWindow& window, const Options& o, const SolveOptions& solve,
                   const Loss& loss, Figures* figures) {
  const auto start = Clock::now();
  Problem problem;
  const auto handles = AddToGraph(window, o.imu ? WindowKind::kVisualInertial : WindowKind::kVision,
                                  {.loss = loss}, &problem);
  if (!handles.ok()) return handles.status();
  const std::chrono::duration<double, std::milli> graph = Clock::now() - start;

  const Snapshot begin = problem.GetSnapshot();
  std::vector<double> linearize, eliminate, linear_solve, cost;
  for (int k = 0; k < o.repeat; ++k) {
    if (k > 0) {
      if (Status s = problem.RestoreSnapshot(begin); !s.ok()) return s;
    }
    const long long allocations = app::num_allocations.load();
    const SolveSummary& summary = problem.Solve(solve);
    if (!summary.ok()) return summary.status;
    if (k > 0) {
      figures->allocations += app::num_allocations.load() - allocations;
      ++figures->repeat_solves;
    } else {
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

nlohmann::ordered_json ToJson(const Figures& f) {
  nlohmann::ordered_json allocations = nullptr;
  if (app::kCanCountAllocations && f.repeat_solves > 0) {
    allocations = static_cast<double>(f.allocations) / static_cast<double>(f.repeat_solves);
  }
  return {{"windows", f.final_costs.size()},
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
          {"isa", InstructionSetName()},
          {"mean_initial_cost", Mean(f.initial_costs)},
          {"mean_final_cost", Mean(f.final_costs)},
          {"costs", f.final_costs}};
}

int Run(const Options& o) {
  SolveOptions solve;
  Loss loss;
  if (Status s = MakeSolveOptions(o, &solve, &loss); !s.ok()) {
    return app::Refuse(kName, s.message());
  }
  const auto windows = ReadViowin(o.file);
  if (!windows.ok()) return app::Refuse(kName, windows.status().message());
  Figures figures;
  for (std::size_t k = 0; k < windows->size(); ++k) {
    const ViowinWindow& window = (*windows)[k];
    if (Status s = SolveWindow(window, o, solve, loss, &figures); !s.ok()) {
      return app::Refuse(kName, fmt::format("{}: window {}: {}", o.file, window.id, s.message()));
    }
  }
  fmt::print("{:>8} {:>18} {:>18}\n", "window", "initial cost", "final cost");
  for (std::size_t k = 0; k < windows->size(); ++k) {
    fmt::print("{:>8} {:>18.10g} {:>18.10g}\n", (*windows)[k].id, figures.initial_costs[k],
               figures.final_costs[k]);
  }
  const nlohmann::ordered_json json = ToJson(figures);
  const auto ms = [&](const char* key) { return json[key].get<double>(); };
  fmt::print("{} windows, {} solves each, {} steps accepted, {} rejected, mean cost {:.10g}\n",
             windows->size(), o.repeat, figures.accepted_steps, figures.rejected_steps,
             ms("mean_final_cost"));
  fmt::print("solve [ms]: median {:.4f}, min {:.4f}, p95 {:.4f}, p99 {:.4f}, max {:.4f} ({})\n",
             ms("median_ms"), ms("min_ms"), ms("p95_ms"), ms("p99_ms"), ms("max_ms"),
             InstructionSetName());
  fmt::print(
      "split [ms]: build {:.4f}; linearize {:.4f}, eliminate {:.4f}, solve {:.4f}, cost "
      "{:.4f}\n",
      ms("build_ms"), ms("linearize_ms"), ms("eliminate_ms"), ms("solve_ms"), ms("cost_ms"));
  if (!json["allocations_per_solve"].is_null()) {
    fmt::print("allocations per repeated solve: {:g}\n", ms("allocations_per_solve"));
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
