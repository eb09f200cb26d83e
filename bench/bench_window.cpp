// requires: ceres
// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The same sliding windows in Ceres and in glissade, in turn, in one process:
//   bench_window [--imu] [--rounds N] FILE...     ratio window by window, exactly 8 linear solves
//   bench_window --converge [--imu] FILE...       time to reach 1e-6 of the reference optimum
//   bench_window --jitter N [--imu] FILE          one window, N times
//   bench_window --once [--imu] [--rounds N] FILE one window, glissade alone: for callgrind
//   bench_window --trace [--imu] FILE             cost and damping step by step, side by side
// --cpu-time measures CPU time instead of wall clock: for a machine with other work on it.
// GLISSADE_ISA=baseline|avx2|avx512 chooses glissade's kernels.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "glissade/eval/statistics.h"
#include "glissade/io/viowin.h"
#include "glissade/linear/instruction_set.h"
#include "glissade/problem/problem.h"
#include "window_ceres.h"

namespace {

using namespace glissade;
using bench::CeresWindow;

constexpr int kSteps = 8;
constexpr double kReached = 1e-6;  // of the reference optimum

struct Options {
  std::vector<std::string> files;
  WindowKind kind = WindowKind::kVision;
  int rounds = 5;
  int jitter = 0;
  bool once = false;
  bool trace = false;
  bool converge = false;
  bool variant = false;  // glissade against itself: with so many threads
  int threads = 1;
};

/// Wall clock, or the CPU time of this thread: on a busy machine the former counts what others do,
/// and counts it against the slower of the two.
bool use_cpu_time = false;

/// Milliseconds.
double Now() {
  timespec t{};
  clock_gettime(use_cpu_time ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}
double Ms(double since) {
  return Now() - since;
}

using eval::Quantile;
double Median(const std::vector<double>& x) {
  return Quantile(x, 0.5);
}
double Mean(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x)
    sum += value;
  return sum / static_cast<double>(x.size());
}

/// Ceres's rules: where damping begins, its bounds, what step is taken.
SolveOptions CeresStyle(int steps) {
  SolveOptions options;
  options.max_iterations = steps;
  options.cost_tolerance = options.gradient_tolerance = options.step_tolerance = 0.0;
  options.damping = Damping::kDiagonal;
  options.initial_lambda = 1e-4;
  options.min_lambda = 1e-16;
  options.min_relative_decrease = 1e-3;
  return options;
}

struct Run {
  double ms = 0.0;
  double whole_ms = 0.0;  // with building the problem from nothing
  double cost = NAN;
  int accepted = 0, rejected = 0;
  [[nodiscard]] int steps() const { return accepted + rejected; }
};

Run SolveCeres(CeresWindow* window, ceres::Solver::Options options) {
  Run run;
  window->Reset();
  const auto begin = Now();
  window->Make();
  const double build = Ms(begin);
  options.linear_solver_ordering = window->Ordering();
  ceres::Solver::Summary summary;
  const auto start = Now();
  ceres::Solve(options, window->problem(), &summary);
  run.ms = Ms(start);
  run.whole_ms = build + run.ms;
  run.cost = summary.final_cost;
  run.accepted = summary.num_successful_steps - 1;  // Ceres counts the start
  run.rejected = summary.num_unsuccessful_steps;
  return run;
}

/// A window in glissade, with its structure kept between solves.
struct GlissadeWindow {
  Problem problem;
  Snapshot begin;

  GlissadeWindow(const ViowinWindow& window, WindowKind kind) {
    const auto handles = AddToGraph(window, kind, {}, &problem);
    if (!handles.ok()) {
      std::fprintf(stderr, "bench_window: %s\n", handles.status().message().c_str());
      std::exit(1);
    }
    begin = problem.GetSnapshot();
  }
  Run Solve(const SolveOptions& options) {
    (void)problem.RestoreSnapshot(begin);
    const auto start = Now();
    const SolveSummary& summary = problem.Solve(options);
    Run run;
    run.ms = Ms(start);
    if (!summary.ok()) std::fprintf(stderr, "glissade: %s\n", summary.status.message().c_str());
    run.cost = summary.final_cost;
    run.accepted = summary.accepted_steps;
    run.rejected = summary.rejected_steps;
    return run;
  }
};

double WholeGlissade(const ViowinWindow& window, WindowKind kind, const SolveOptions& options) {
  const auto start = Now();
  Problem problem;
  (void)AddToGraph(window, kind, {}, &problem).ok();
  problem.Solve(options);
  return Ms(start);
}

void Compare(const std::string& file, const std::vector<ViowinWindow>& windows, const Options& o) {
  const SolveOptions options = CeresStyle(kSteps);
  const ceres::Solver::Options ceres_options = CeresWindow::Options(kSteps);
  std::vector<double> ceres_ms, our_ms, ratio, whole_ratio, whole_ms, ceres_cost, our_cost;
  int accepted[2] = {}, rejected[2] = {}, other_steps = 0;
  double worst = -INFINITY;
  for (const ViowinWindow& window : windows) {
    CeresWindow theirs(window, o.kind);
    GlissadeWindow ours(window, o.kind);
    Run a, b;
    std::vector<double> ms[2], whole[2];
    ours.Solve(options);  // both have warm caches from the second round on: one to warm up
    SolveCeres(&theirs, ceres_options);
    for (int round = 0; round < o.rounds; ++round) {
      for (int turn = 0; turn < 2; ++turn) {
        // Two solves in a row, both counted: the first finds the caches of the other side.
        if ((turn + round) % 2 == 0) {
          for (int repeat = 0; repeat < 2; ++repeat) {
            a = SolveCeres(&theirs, ceres_options);
            ms[0].push_back(a.ms);
            whole[0].push_back(a.whole_ms);
          }
        } else {
          for (int repeat = 0; repeat < 2; ++repeat) {
            b = ours.Solve(options);
            ms[1].push_back(b.ms);
          }
          whole[1].push_back(WholeGlissade(window, o.kind, options));
        }
      }
    }
    ceres_ms.push_back(Median(ms[0]));
    our_ms.push_back(Median(ms[1]));
    whole_ms.push_back(Median(whole[1]));
    ratio.push_back(ceres_ms.back() / our_ms.back());
    whole_ratio.push_back(Median(whole[0]) / Median(whole[1]));
    accepted[0] += a.accepted;
    rejected[0] += a.rejected;
    accepted[1] += b.accepted;
    rejected[1] += b.rejected;
    if (a.steps() != kSteps || b.steps() != kSteps) ++other_steps;
    ceres_cost.push_back(a.cost);
    our_cost.push_back(b.cost);
    worst = std::max(worst, (b.cost - a.cost) / a.cost);
  }
  const char* kind = o.kind == WindowKind::kVision ? "vision" : "imu";
  std::printf("%s %s, %zu windows, %d rounds, %d linear solves, %s, glissade with %s\n",
              file.c_str(), kind, windows.size(), o.rounds, kSteps,
              use_cpu_time ? "CPU time" : "wall clock", InstructionSetName());
  std::printf("  solve [ms]  ceres %.3f  glissade %.4f   ratio median %.2f  min %.2f  max %.2f\n",
              Median(ceres_ms), Median(our_ms), Median(ratio), Quantile(ratio, 0.0),
              Quantile(ratio, 1.0));
  std::printf("  with building the problem: glissade %.4f ms, ratio median %.2f  min %.2f\n",
              Median(whole_ms), Median(whole_ratio), Quantile(whole_ratio, 0.0));
  std::printf("  steps accepted+rejected  ceres %d+%d  glissade %d+%d%s\n", accepted[0],
              rejected[0], accepted[1], rejected[1],
              other_steps > 0 ? "  (NOT all windows: 8)" : "");
  std::printf("  mean final cost  ceres %.7f  glissade %.7f   worst excess of glissade %.2e\n",
              Mean(ceres_cost), Mean(our_cost), worst);
  std::fflush(stdout);
}

// ---- glissade against itself -------------------------------------------------------------------

/// Two threads against one.
void CompareVariant(const std::string& file, const std::vector<ViowinWindow>& windows,
                    const Options& o) {
  const SolveOptions options = CeresStyle(kSteps);
  SolveOptions variant = options;
  variant.num_threads = o.threads;
  std::vector<double> our_ms, variant_ms, ratio;
  int different = 0;
  for (const ViowinWindow& window : windows) {
    GlissadeWindow ours(window, o.kind), other(window, o.kind);
    std::vector<double> ms[2];
    Run a = ours.Solve(options), b = other.Solve(variant);
    for (int round = 0; round < 2 * o.rounds; ++round) {
      a = ours.Solve(options);
      ms[0].push_back(a.ms);
      b = other.Solve(variant);
      ms[1].push_back(b.ms);
    }
    our_ms.push_back(Median(ms[0]));
    variant_ms.push_back(Median(ms[1]));
    ratio.push_back(variant_ms.back() / our_ms.back());
    different += a.cost != b.cost;
  }
  std::printf(
      "%s %s, %d threads: %.4f ms against %.4f, ratio median %.3f  min %.3f  max "
      "%.3f; final costs that differ in a bit: %d of %zu\n",
      file.c_str(), o.kind == WindowKind::kVision ? "vision" : "imu", o.threads, Median(variant_ms),
      Median(our_ms), Median(ratio), Quantile(ratio, 0.0), Quantile(ratio, 1.0), different,
      windows.size());
  std::fflush(stdout);
}

// ---- Time to the optimum -----------------------------------------------------------------------

/// Optima of a file's windows from reference_costs.csv beside it; empty where there is none.
std::vector<double> ReadOptima(const std::string& file, WindowKind kind) {
  const std::size_t slash = file.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : file.substr(0, slash + 1);
  std::string name = file.substr(folder.size());
  if (name.size() > 3 && name.substr(name.size() - 3) == ".gz") name.resize(name.size() - 3);
  std::vector<double> optima;
  std::ifstream in(folder + "reference_costs.csv");
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::string of_file;
    double window, start[2], optimum[2];
    words >> of_file >> window >> start[0] >> optimum[0] >> start[1] >> optimum[1];
    if (words && of_file == name) optima.push_back(optimum[kind == WindowKind::kVision ? 0 : 1]);
  }
  return optima;
}

/// Ends a Ceres solve at a cost.
class StopAt final : public ceres::IterationCallback {
 public:
  explicit StopAt(double cost) : cost_(cost) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& it) override {
    return it.cost <= cost_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  double cost_;
};

void Converge(const std::string& file, const std::vector<ViowinWindow>& windows, const Options& o) {
  constexpr int kMost = 200;
  const std::vector<double> optima = ReadOptima(file, o.kind);
  if (optima.size() != windows.size()) {
    std::printf("%s: no reference optima\n", file.c_str());
    return;
  }
  std::vector<double> ceres_ms, our_ms, ratio, ceres_steps, our_steps;
  int reached[2] = {};
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const double goal = optima[w] * (1.0 + kReached);
    StopAt stop(goal);
    ceres::Solver::Options ceres_options = CeresWindow::Options(kMost);
    ceres_options.callbacks.push_back(&stop);
    SolveOptions options = CeresStyle(kMost);
    options.callback = [goal](const IterationSummary& it) {
      return it.cost <= goal ? CallbackAction::kStop : CallbackAction::kContinue;
    };
    CeresWindow theirs(windows[w], o.kind);
    GlissadeWindow ours(windows[w], o.kind);
    std::vector<double> ms[2];
    Run a, b;
    for (int round = 0; round < o.rounds + 1; ++round) {
      a = SolveCeres(&theirs, ceres_options);
      b = ours.Solve(options);
      if (round == 0) continue;  // to warm up
      ms[0].push_back(a.ms);
      ms[1].push_back(b.ms);
    }
    reached[0] += a.cost <= goal ? 1 : 0;
    reached[1] += b.cost <= goal ? 1 : 0;
    ceres_ms.push_back(Median(ms[0]));
    our_ms.push_back(Median(ms[1]));
    ratio.push_back(ceres_ms.back() / our_ms.back());
    ceres_steps.push_back(a.steps());
    our_steps.push_back(b.steps());
  }
  std::printf("%s %s, to 1e-6 of the optimum, %zu windows, %d rounds, glissade with %s\n",
              file.c_str(), o.kind == WindowKind::kVision ? "vision" : "imu", windows.size(),
              o.rounds, InstructionSetName());
  std::printf("  reached  ceres %d  glissade %d;  mean steps  ceres %.2f  glissade %.2f\n",
              reached[0], reached[1], Mean(ceres_steps), Mean(our_steps));
  std::printf("  time [ms]  ceres %.3f  glissade %.4f   ratio median %.2f  min %.2f\n",
              Median(ceres_ms), Median(our_ms), Median(ratio), Quantile(ratio, 0.0));
  std::fflush(stdout);
}

void Jitter(const std::string& file, const ViowinWindow& window, const Options& o) {
  CeresWindow theirs(window, o.kind);
  GlissadeWindow ours(window, o.kind);
  const SolveOptions options = CeresStyle(kSteps);
  const ceres::Solver::Options ceres_options = CeresWindow::Options(kSteps);
  std::vector<double> ms[2];
  for (int k = 0; k < o.jitter + 10; ++k) {
    const double a = SolveCeres(&theirs, ceres_options).ms, b = ours.Solve(options).ms;
    if (k < 10) continue;
    ms[0].push_back(a);
    ms[1].push_back(b);
  }
  std::printf("%s %s, window 0 solved %d times in turn, glissade with %s\n", file.c_str(),
              o.kind == WindowKind::kVision ? "vision" : "imu", o.jitter, InstructionSetName());
  for (int k = 0; k < 2; ++k) {
    const double median = Median(ms[k]), p99 = Quantile(ms[k], 0.99);
    std::printf("  %-8s median %.4f ms  p99 %.4f ms  p99/median %.3f  max %.4f ms\n",
                k == 0 ? "ceres" : "glissade", median, p99, p99 / median, Quantile(ms[k], 1.0));
  }
  std::fflush(stdout);
}

/// Cost and damping step by step, side by side: where the two part.
void Trace(const ViowinWindow& window, const Options& o) {
  ceres::Solver::Summary theirs;
  CeresWindow ceres_window(window, o.kind);
  ceres_window.Make();
  ceres::Solver::Options ceres_options = CeresWindow::Options(kSteps);
  ceres_options.linear_solver_ordering = ceres_window.Ordering();
  ceres::Solve(ceres_options, ceres_window.problem(), &theirs);
  GlissadeWindow ours(window, o.kind);
  const SolveSummary& summary = ours.problem.Solve(CeresStyle(kSteps));
  std::printf("window %lld: tried decrease, gain ratio, lambda, accepted\n",
              static_cast<long long>(window.id));
  const std::size_t n = std::min(theirs.iterations.size(), summary.iterations.size());
  for (std::size_t k = 0; k < n; ++k) {
    const ceres::IterationSummary& a = theirs.iterations[k];
    const IterationSummary& b = summary.iterations[k];
    std::printf("  %zu  %.12g %.4e %.6f %.3e %d | %.12g %.4e %.6f %.3e %d\n", k, a.cost,
                a.cost_change, a.relative_decrease, 1.0 / a.trust_region_radius,
                a.step_is_successful ? 1 : 0, b.cost, b.cost_change, b.gain_ratio, b.lambda,
                b.accepted ? 1 : 0);
  }
}

int Usage(const char* why) {
  std::fprintf(
      stderr,
      "bench_window: %s\nbench_window [--imu] [--cpu-time] [--rounds N] [--converge | --jitter N | "
      "--once | --threads N] FILE...\n",
      why);
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  for (int k = 1; k < argc; ++k) {
    const std::string arg = argv[k];
    const auto number = [&] { return k + 1 < argc ? std::atoi(argv[++k]) : 0; };
    if (arg == "--cpu-time") {
      use_cpu_time = true;
    } else if (arg == "--imu") {
      o.kind = WindowKind::kVisualInertial;
    } else if (arg == "--rounds") {
      if ((o.rounds = number()) < 1) return Usage("--rounds: a number from 1 on");
    } else if (arg == "--jitter") {
      if ((o.jitter = number()) < 1) return Usage("--jitter: a number from 1 on");
    } else if (arg == "--threads") {
      if ((o.threads = number()) < 1) return Usage("--threads: a number from 1 on");
      o.variant = true;
    } else if (arg == "--trace") {
      o.trace = true;
    } else if (arg == "--once") {
      o.once = true;
    } else if (arg == "--converge") {
      o.converge = true;
    } else if (arg.rfind("--", 0) == 0) {
      return Usage(("unknown option " + arg).c_str());
    } else {
      o.files.push_back(arg);
    }
  }
  if (o.files.empty()) return Usage("no file");
  for (const std::string& file : o.files) {
    const auto windows = ReadViowin(file);
    if (!windows.ok()) return Usage(windows.status().message().c_str());
    for (const ViowinWindow& window : *windows) {
      if (!window.marginal_priors.empty()) return Usage("marginal priors are not compared");
    }
    if (o.trace) {
      for (const ViowinWindow& window : *windows)
        Trace(window, o);
    } else if (o.once) {
      GlissadeWindow window(windows->front(), o.kind);
      for (int round = 0; round < o.rounds; ++round)
        std::printf("%.10g\n", window.Solve(CeresStyle(kSteps)).cost);
    } else if (o.jitter > 0) {
      Jitter(file, windows->front(), o);
    } else if (o.variant) {
      CompareVariant(file, *windows, o);
    } else if (o.converge) {
      Converge(file, *windows, o);
    } else {
      Compare(file, *windows, o);
    }
  }
  return 0;
}
