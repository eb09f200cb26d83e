// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ba/run.h"
#include "ba/solvers.h"

namespace glissade::bench {

/// Cost that counts as arrived: within this part of (initial - best of all solvers) of the best.
inline constexpr double kTolerances[] = {1e-1, 1e-2, 1e-3};

struct SolverRuns {
  const Solver* solver = nullptr;
  std::vector<Run> runs;  ///< one a round
};

/// What all rounds and solvers made of a problem.
struct ProblemRuns {
  std::string name;
  std::string path;  ///< of the file that all solvers read
  int cameras = 0, points = 0, observations = 0;
  double initial_cost = NAN;  ///< audited
  std::vector<SolverRuns> solvers;

  /// The least that any solver has come to, audited.
  [[nodiscard]] double BestCost() const;
};

/// For people, to standard output.
void PrintTable(const ProblemRuns& problem, const Settings& settings);

/// For scripts/plot_bench_ba.py; false where the file cannot be written. Numbers that are none are
/// null.
bool WriteJson(const std::string& path, const std::vector<ProblemRuns>& problems,
               const Settings& settings);

}  // namespace glissade::bench
