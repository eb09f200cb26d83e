// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// CheckNullspace on windows, in microseconds: from the linearization that the last solve left, and
// with a fresh one.
//   bench_gauge [--rounds N] FILE...   every window of the files, visual-inertial and vision only,
//                                      without their absolute priors and with them
//   bench_gauge --once FILE            one check from the last linearization: for callgrind
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "glissade/gauge/nullspace.h"
#include "glissade/io/viowin.h"
#include "glissade/linear/instruction_set.h"
#include "glissade/problem/problem.h"
#include "timing.h"

namespace {

using namespace glissade;
using bench::Median;
using bench::ThreadSeconds;

void RemoveAbsolutePriors(Problem* problem) {
  for (const AnyEdge& edge : problem->Edges()) {
    if (edge.type == &kTypeInfo<EdgePosePriorVec> || edge.type == &kTypeInfo<EdgeSpeedBiasPrior>) {
      (void)problem->RemoveEdge(edge);
    }
  }
}

struct Times {
  std::vector<double> last, fresh;
  double kappa = 0.0;
  std::size_t edges = 0;
};

bool Measure(const ViowinWindow& window, WindowKind kind, bool priors, int rounds, Times* times) {
  Problem problem;
  if (!AddToGraph(window, kind, {}, &problem).ok()) return false;
  if (!priors) RemoveAbsolutePriors(&problem);
  if (!problem.Solve({.max_iterations = 8}).ok()) return false;
  std::vector<double> last, fresh;
  for (int round = 0; round < rounds; ++round) {
    double begin = ThreadSeconds();
    const auto report = problem.CheckNullspace();
    last.push_back(1e6 * (ThreadSeconds() - begin));
    if (!report.ok()) return false;
    times->kappa = std::max(times->kappa, report->MaxKappa());
    times->edges += round == 0 ? report->edges.size() : 0;
    begin = ThreadSeconds();
    const auto again = CheckNullspace(static_cast<Graph*>(&problem));
    fresh.push_back(1e6 * (ThreadSeconds() - begin));
    if (!again.ok()) return false;
  }
  times->last.push_back(Median(last));
  times->fresh.push_back(Median(fresh));
  return true;
}

int Once(const std::vector<ViowinWindow>& windows) {
  Problem problem;
  if (!AddToGraph(windows.front(), WindowKind::kVisualInertial, {}, &problem).ok()) return 1;
  RemoveAbsolutePriors(&problem);
  if (!problem.Solve({.max_iterations = 8}).ok()) return 1;
  const auto report = problem.CheckNullspace();
  if (!report.ok()) return 1;
  for (const NullspaceDirection& direction : report->directions) {
    std::printf("%-6s kappa %.2g\n", std::string(direction.name).c_str(), direction.kappa);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 101;
  bool once = false;
  std::vector<std::string> files;
  for (int k = 1; k < argc; ++k) {
    const std::string arg = argv[k];
    if (arg == "--rounds" && k + 1 < argc) {
      rounds = std::max(1, std::atoi(argv[++k]));
    } else if (arg == "--once") {
      once = true;
    } else {
      files.push_back(arg);
    }
  }
  if (files.empty()) {
    std::fprintf(stderr, "usage: bench_gauge [--rounds N | --once] FILE...\n");
    return 2;
  }
  std::printf("instruction set %s, CPU time, medians of %d rounds\n", InstructionSetName(), rounds);
  for (const std::string& file : files) {
    const auto windows = ReadViowin(file);
    if (!windows.ok()) {
      std::fprintf(stderr, "%s\n", windows.status().message().c_str());
      return 1;
    }
    if (once) return Once(*windows);
    std::printf("%s, %zu windows, %zu keyframes\n", file.c_str(), windows->size(),
                windows->front().keyframes.size());
    for (const WindowKind kind : {WindowKind::kVisualInertial, WindowKind::kVision}) {
      for (const bool priors : {false, true}) {
        Times times;
        for (const ViowinWindow& window : *windows) {
          if (!Measure(window, kind, priors, rounds, &times)) {
            std::fprintf(stderr, "a window failed\n");
            return 1;
          }
        }
        std::printf(
            "  %-15s %-15s last linearization %6.1f us  fresh %7.1f us  kappa %.1e  edges named "
            "%zu\n",
            kind == WindowKind::kVision ? "vision" : "visual-inertial",
            priors ? "with priors" : "without priors", Median(times.last), Median(times.fresh),
            times.kappa, times.edges);
      }
    }
  }
  return 0;
}
