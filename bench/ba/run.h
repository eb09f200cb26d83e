// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

/// \file
/// What is measured of one solver on one problem. It comes out of a process of its own line by
/// line, so that what there was is known too of one that was ended.
namespace glissade::bench {

struct Settings {
  int rounds = 3;
  int steps = 10;
  int threads = 1;
  /// How exact an iterative solver's steps are: Ceres's eta, our PcgOptions::forcing. Both stop
  /// where an iteration brings less than this part of what the model has decreased so far.
  double eta = 0.1;
  double time_limit_s = 600.0;   ///< wall clock, of a solve
  double memory_limit_mb = 0.0;  ///< of a solver's process (RLIMIT_AS); 0: none

  /// CPU time of the process on one thread: what others do on the machine is not counted. With more
  /// it would count all of them, and the wall clock is what a user waits for.
  [[nodiscard]] bool CpuClock() const { return threads == 1; }
};

struct Step {
  double seconds = 0.0;  ///< since the solve began
  double cost = 0.0;     ///< after it, as the solver says
  bool accepted = true;
  int cg = 0;  ///< iterations of conjugate gradients
};

struct Run {
  std::string end;       ///< "done", or why it ended before: "time limit", "out of memory", ...
  std::string chosen;    ///< what a solver that chooses has chosen, and why
  double setup_s = NAN;  ///< from the file's content to the solver's own graph
  double solve_s = NAN;
  std::vector<Step> steps;  ///< the first is the start
  double cost = NAN;        ///< at the end, as the solver says
  double audited = NAN;     ///< the same, computed from the solution by audit.h
  double peak_mb = NAN;     ///< most memory of the process until then (VmHWM)

  [[nodiscard]] bool done() const { return end == "done"; }
  /// Seconds of each accepted step but the first.
  [[nodiscard]] std::vector<double> StepSeconds() const;
  /// When the cost had come to `cost`; NaN where it has not.
  [[nodiscard]] double SecondsTo(double cost) const;
  [[nodiscard]] int CgIterations() const;
};

/// In the process of the solver: tells what happens as it happens.
class Recorder {
 public:
  Recorder(std::FILE* to, bool cpu_clock) : to_(to), cpu_clock_(cpu_clock), start_(Now()) {}

  void SolveBegins();
  void Step(double cost, bool accepted, int cg);
  /// The solution is there; peak memory is that until here.
  void SolveEnds(double cost, std::string_view chosen);
  void Audited(double cost);
  void Fails(std::string_view why);

 private:
  [[nodiscard]] double Now() const;

  std::FILE* to_;
  bool cpu_clock_;
  double start_;
};

/// In the parent: what a line of a Recorder says.
void ReadLine(const std::string& line, Run* run);

}  // namespace glissade::bench
