// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Bundle adjustment in glissade and in Ceres, in turn, each solve in a process of its own:
//   bench_ba FILE...                      BAL files ("Bundle Adjustment in the Large")
//   bench_ba --city 200,1000              simulated cities of so many cameras
//   bench_ba --only glissade-auto,ceres-sparse --threads 2 --json result.json FILE...
//   bench_ba --once [--steps N] FILE      glissade alone, in this process: for callgrind, perf
// Time of an accepted step, time until the cost has come down, peak memory, iterations of conjugate
// gradients, and what the solution costs, computed anew from its cameras and points (ba/audit.h).
// Ceres has analytic Jacobians, a cost function of fixed sizes, an elimination ordering, no safety
// checks. GLISSADE_ISA=baseline|avx2|avx512 chooses glissade's kernels.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "ba/audit.h"
#include "ba/child.h"
#include "ba/problem_file.h"
#include "ba/report.h"
#include "ba/run.h"
#include "ba/solvers.h"
#include "glissade/io/bal.h"
#include "timing.h"

namespace {

using namespace glissade;
using namespace glissade::bench;

struct Options {
  std::vector<ProblemSource> problems;
  std::vector<std::string> only;  // names of solvers; empty: those of Solver::by_default
  Settings settings;
  std::uint32_t seed = 1;
  std::string json;
  bool once = false;
};

std::vector<Solver> AllSolvers() {
  std::vector<Solver> all = GlissadeSolvers();
  for (Solver& solver : CeresSolvers())
    all.push_back(std::move(solver));
  return all;
}

int Usage(const std::string& why) {
  std::fprintf(stderr,
               "bench_ba: %s\n"
               "bench_ba [OPTION...] [--city N[,N...]] [FILE...]\n"
               "  --only NAME[,NAME...]  solvers, of those below\n"
               "  --rounds N             each solver N times, in turn (3)\n"
               "  --steps N              at most N steps (10)\n"
               "  --threads N            1: CPU time of the process; more: wall clock (1)\n"
               "  --eta X                how exact steps of iterative solvers are (0.1)\n"
               "  --time-limit S         of a solve, wall clock (600)\n"
               "  --memory-limit MB      of a solver's process\n"
               "  --seed N               of cities (1)\n"
               "  --json FILE            all figures and traces\n"
               "  --once                 glissade-auto in this process, one FILE\n\n",
               why.c_str());
  for (const Solver& solver : AllSolvers()) {
    std::fprintf(stderr, "  %-26s %s%s%s\n", solver.name.c_str(), solver.about.c_str(),
                 solver.max_cameras < 1 << 30 ? "; up to 300 cameras" : "",
                 solver.by_default ? "" : "; only where asked for");
  }
  return 2;
}

std::vector<std::string> Split(std::string_view list) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    parts.emplace_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// The whole text as a number from low to high; else false.
template <class Number>
bool Parse(std::string_view text, Number low, Number high, Number* number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
  return error == std::errc() && end == text.data() + text.size() && *number >= low &&
         *number <= high;
}

/// What is wrong with the command line; empty where nothing is.
std::string Read(int argc, char** argv, Options* o) {
  std::vector<std::string> cities;
  Settings& s = o->settings;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (a == "--once") {
      o->once = true;
      continue;
    }
    if (!a.starts_with("--")) {
      o->problems.emplace_back().file = a;
      continue;
    }
    if (i + 1 == argc) return a + ": unknown, or without what it needs";
    const std::string_view value = argv[++i];
    bool known = true, good = true;
    if (a == "--city") {
      cities = Split(value);
    } else if (a == "--only") {
      o->only = Split(value);
    } else if (a == "--json") {
      o->json = value;
    } else if (a == "--rounds") {
      good = Parse(value, 1, 1000, &s.rounds);
    } else if (a == "--steps") {
      good = Parse(value, 1, 100000, &s.steps);
    } else if (a == "--threads") {
      good = Parse(value, 1, 1024, &s.threads);
    } else if (a == "--seed") {
      good = Parse(value, std::uint32_t{0}, ~std::uint32_t{0}, &o->seed);
    } else if (a == "--eta") {
      good = Parse(value, 0.0, 1.0, &s.eta);
    } else if (a == "--time-limit") {
      good = Parse(value, 1e-3, 1e6, &s.time_limit_s);
    } else if (a == "--memory-limit") {
      good = Parse(value, 1.0, 1e9, &s.memory_limit_mb);
    } else {
      known = false;
    }
    if (!known) return a + ": unknown";
    if (!good) return a + ": not " + argv[i];
  }
  for (const std::string& city : cities) {
    ProblemSource source;
    source.seed = o->seed;
    if (!Parse(city, 20, 20000, &source.city)) return "--city: not " + city;
    o->problems.push_back(source);
  }
  if (o->problems.empty()) return "no problem to solve";
  if (o->once && (o->problems.size() > 1 || o->problems[0].city != 0)) return "--once: one FILE";
  return "";
}

/// Solves and audits; in a process of its own.
void SolveOnce(const Solver& solver, const std::string& path, const Settings& settings,
               std::FILE* out) {
  auto problem = ReadBal(path);
  if (!problem.ok()) {
    Recorder(out, settings.CpuClock()).Fails(problem.status().message());
    return;
  }
  Recorder recorder(out, settings.CpuClock());
  const auto solution = solver.solve(std::move(problem).value(), settings, &recorder);
  if (!solution.ok()) {
    recorder.Fails(solution.status().message());
    return;
  }
  // What was measured, as the file has it: the solver's own graph is not asked.
  const auto again = ReadBal(path);
  if (again.ok()) recorder.Audited(AuditedCost(*solution, again->observations));
}

Run RunSolver(const Solver& solver, const std::string& path, const Settings& settings) {
  Run run;
  // A solver ends by itself at its limit where it looks at the clock.
  const ChildLimits limits{1.5 * settings.time_limit_s + 10.0, settings.memory_limit_mb};
  const std::string end =
      RunInChild([&](std::FILE* out) { SolveOnce(solver, path, settings, out); }, limits,
                 [&](const std::string& line) { ReadLine(line, &run); });
  if (run.end.empty()) run.end = end;
  return run;
}

/// All solvers in turn, round by round: what the machine does meanwhile, it does to all.
void Compare(const std::vector<Solver>& solvers, const Settings& settings, ProblemRuns* problem) {
  for (const Solver& solver : solvers) {
    if (problem->cameras <= solver.max_cameras) problem->solvers.push_back({&solver, {}});
  }
  for (int round = 0; round < settings.rounds; ++round) {
    for (SolverRuns& runs : problem->solvers) {
      std::fprintf(stderr, "%s, round %d of %d: %s\n", problem->name.c_str(), round + 1,
                   settings.rounds, runs.solver->name.c_str());
      runs.runs.push_back(RunSolver(*runs.solver, problem->path, settings));
    }
  }
}

int Once(const std::string& path, const Settings& settings) {
  auto problem = ReadBal(path);
  if (!problem.ok()) return Usage(problem.status().message());
  std::FILE* const lines = std::tmpfile();
  if (lines == nullptr) return 1;
  Recorder recorder(lines, true);
  const Solver solver = GlissadeSolvers().front();
  const auto solution = solver.solve(std::move(problem).value(), settings, &recorder);
  if (!solution.ok()) return Usage(solution.status().message());
  std::rewind(lines);
  Run run;
  for (char line[512]; std::fgets(line, sizeof line, lines) != nullptr;)
    ReadLine(line, &run);
  std::fclose(lines);
  std::printf("%s: %.2f ms/step, cost %.8e\n", path.c_str(), 1e3 * Median(run.StepSeconds()),
              run.cost);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  if (const std::string why = Read(argc, argv, &o); !why.empty()) return Usage(why);
  if (o.once) return Once(o.problems[0].file, o.settings);
  std::vector<Solver> solvers;
  const std::vector<Solver> all = AllSolvers();
  for (const Solver& solver : all) {
    const bool named = std::find(o.only.begin(), o.only.end(), solver.name) != o.only.end();
    if (named || (o.only.empty() && solver.by_default)) solvers.push_back(solver);
  }
  if (solvers.size() < o.only.size()) return Usage("--only: there is no such solver");

  TemporaryFolder folder;
  std::vector<ProblemRuns> problems;
  int exit_code = 0;
  for (const ProblemSource& source : o.problems) {
    std::string why;
    ProblemRuns problem = PrepareProblem(source, folder.Add("problem.bbal"), &why);
    if (!why.empty()) {
      std::fprintf(stderr, "bench_ba: %s: %s\n", problem.name.c_str(), why.c_str());
      exit_code = 2;
      continue;
    }
    Compare(solvers, o.settings, &problem);
    PrintTable(problem, o.settings);
    problems.push_back(std::move(problem));
    // After each: what comes later may take hours.
    if (!o.json.empty() && !WriteJson(o.json, problems, o.settings)) {
      std::fprintf(stderr, "bench_ba: %s cannot be written\n", o.json.c_str());
      return 2;
    }
  }
  return exit_code;
}
