// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/report.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

#include "glissade/linear/instruction_set.h"
#include "timing.h"

namespace glissade::bench {

namespace {

/// What is said of one solver: medians over its rounds, NaN where there is nothing to say.
struct Figures {
  double step_s = NAN;
  double ratio = NAN;  // of step_s to that of the first solver in the same round
  double to_s[std::size(kTolerances)];
  double solve_s = NAN, setup_s = NAN;
  double peak_mb = NAN;  // the largest
  double cg_per_step = NAN;
  double cost = NAN, audited = NAN;
  std::string end = "done", chosen;
};

/// Median of what is a number in every round, else NaN.
template <class Get>
double Over(const SolverRuns& solver, const Get& get) {
  std::vector<double> values;
  for (const Run& run : solver.runs)
    values.push_back(get(run));
  for (const double value : values) {
    if (!std::isfinite(value)) return NAN;
  }
  return Median(std::move(values));
}

Figures FiguresOf(const ProblemRuns& problem, const SolverRuns& solver) {
  Figures f;
  f.step_s = Over(solver, [](const Run& run) { return Median(run.StepSeconds()); });
  std::vector<double> ratios;
  const std::vector<Run>& first = problem.solvers.front().runs;
  for (std::size_t k = 0; k < std::min(first.size(), solver.runs.size()); ++k) {
    ratios.push_back(Median(solver.runs[k].StepSeconds()) / Median(first[k].StepSeconds()));
  }
  std::erase_if(ratios, [](double ratio) { return !std::isfinite(ratio); });
  f.ratio = Median(ratios);
  const double best = problem.BestCost();
  for (std::size_t k = 0; k < std::size(kTolerances); ++k) {
    const double wanted = best + kTolerances[k] * (problem.initial_cost - best);
    f.to_s[k] = Over(solver, [&](const Run& run) { return run.SecondsTo(wanted); });
  }
  f.solve_s = Over(solver, [](const Run& run) { return run.solve_s; });
  f.setup_s = Over(solver, [](const Run& run) { return run.setup_s; });
  f.cg_per_step = Over(solver, [](const Run& run) {
    return static_cast<double>(run.CgIterations()) / static_cast<double>(run.steps.size() - 1);
  });
  f.cost = Over(solver, [](const Run& run) { return run.cost; });
  f.audited = Over(solver, [](const Run& run) { return run.audited; });
  for (const Run& run : solver.runs) {
    if (!(run.peak_mb <= f.peak_mb)) f.peak_mb = run.peak_mb;
    if (!run.done()) f.end = run.end;
    f.chosen = run.chosen;
  }
  return f;
}

/// "1.23" with three digits, "-" where there is no number.
std::string Short(double value) {
  if (!std::isfinite(value)) return "-";
  char text[32];
  const int digits = value >= 100.0  ? 0
                     : value >= 10.0 ? 1
                     : value >= 1.0  ? 2
                     : value >= 0.1  ? 3
                                     : 4;
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

// ---- JSON
// -----------------------------------------------------------------------------------------
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return quoted.append("\"");
}

std::string Number(double value) {
  if (!std::isfinite(value)) return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

void WriteRun(std::FILE* file, const Run& run) {
  std::fprintf(
      file,
      "      {\"end\": %s, \"setup_s\": %s, \"solve_s\": %s, \"peak_mb\": %s, \"cost\": %s, "
      "\"audited_cost\": %s,\n       \"trace\": [",
      Quoted(run.end).c_str(), Number(run.setup_s).c_str(), Number(run.solve_s).c_str(),
      Number(run.peak_mb).c_str(), Number(run.cost).c_str(), Number(run.audited).c_str());
  for (std::size_t k = 0; k < run.steps.size(); ++k) {
    const Step& step = run.steps[k];
    std::fprintf(file, "%s[%s, %s, %d, %d]", k == 0 ? "" : ", ", Number(step.seconds).c_str(),
                 Number(step.cost).c_str(), step.accepted ? 1 : 0, step.cg);
  }
  std::fprintf(file, "]}");
}

void WriteSolver(std::FILE* file, const ProblemRuns& problem, const SolverRuns& solver) {
  const Figures f = FiguresOf(problem, solver);
  std::fprintf(file,
               "    {\"name\": %s, \"about\": %s, \"end\": %s, \"chosen\": %s,\n"
               "     \"step_s\": %s, \"ratio\": %s, \"to_1e-1_s\": %s, \"to_1e-2_s\": %s, "
               "\"to_1e-3_s\": %s, \"setup_s\": %s, \"solve_s\": %s,\n"
               "     \"peak_mb\": %s, \"cg_per_step\": %s, \"cost\": %s, \"audited_cost\": %s,\n"
               "     \"runs\": [\n",
               Quoted(solver.solver->name).c_str(), Quoted(solver.solver->about).c_str(),
               Quoted(f.end).c_str(), Quoted(f.chosen).c_str(), Number(f.step_s).c_str(),
               Number(f.ratio).c_str(), Number(f.to_s[0]).c_str(), Number(f.to_s[1]).c_str(),
               Number(f.to_s[2]).c_str(), Number(f.setup_s).c_str(), Number(f.solve_s).c_str(),
               Number(f.peak_mb).c_str(), Number(f.cg_per_step).c_str(), Number(f.cost).c_str(),
               Number(f.audited).c_str());
  for (std::size_t k = 0; k < solver.runs.size(); ++k) {
    WriteRun(file, solver.runs[k]);
    std::fprintf(file, k + 1 < solver.runs.size() ? ",\n" : "]}");
  }
}

}  // namespace

double ProblemRuns::BestCost() const {
  double best = NAN;
  for (const SolverRuns& solver : solvers) {
    for (const Run& run : solver.runs) {
      if (!(run.audited >= best) && std::isfinite(run.audited)) best = run.audited;
    }
  }
  return best;
}

void PrintTable(const ProblemRuns& problem, const Settings& settings) {
  std::printf("%s: %d cameras, %d points, %d observations; cost %.6e, at best %.9e\n",
              problem.name.c_str(), problem.cameras, problem.points, problem.observations,
              problem.initial_cost, problem.BestCost());
  std::printf("%s; medians of %d rounds of at most %d steps; eta %g; glissade's kernels: %s",
              settings.CpuClock()
                  ? "one thread, CPU time of the process"
                  : std::to_string(settings.threads).append(" threads, wall clock").c_str(),
              settings.rounds, settings.steps, settings.eta, InstructionSetName());
  const std::string ceres = CeresVersion();
  if (!ceres.empty()) std::printf("; Ceres %s", ceres.c_str());
  std::printf("\n  %-26s %8s %6s  %8s %8s %8s  %8s %6s  %-17s\n", "", "s/step", "ratio", "to 1e-1",
              "1e-2", "1e-3", "peak MB", "CG", "audited cost");
  for (const SolverRuns& solver : problem.solvers) {
    const Figures f = FiguresOf(problem, solver);
    std::printf("  %-26s %8s %6s  %8s %8s %8s  %8s %6s  ", solver.solver->name.c_str(),
                Short(f.step_s).c_str(), Short(f.ratio).c_str(), Short(f.to_s[0]).c_str(),
                Short(f.to_s[1]).c_str(), Short(f.to_s[2]).c_str(), Short(f.peak_mb).c_str(),
                f.cg_per_step > 0.0 ? Short(f.cg_per_step).c_str() : "-");
    if (std::isfinite(f.audited)) {
      std::printf("%.11e", f.audited);
    } else {
      std::printf("%-17s", "-");
    }
    // The solver's own word, where it is not what the solution costs.
    if (std::abs(f.cost - f.audited) > 1e-9 * f.audited) std::printf("  (it says %.11e)", f.cost);
    if (f.end != "done") std::printf("  [%s]", f.end.c_str());
    if (f.chosen.find(':') != std::string::npos) std::printf("  %s", f.chosen.c_str());
    std::printf("\n");
  }
  std::fflush(stdout);
}

bool WriteJson(const std::string& path, const std::vector<ProblemRuns>& problems,
               const Settings& settings) {
  std::FILE* const file = std::fopen(path.c_str(), "w");
  if (file == nullptr) return false;
  std::fprintf(
      file,
      "{\"schema\": 1, \"tool\": \"bench_ba\", \"isa\": %s, \"ceres\": %s, \"clock\": %s,\n"
      " \"threads\": %d, \"rounds\": %d, \"steps\": %d, \"eta\": %s, \"time_limit_s\": %s,\n"
      " \"problems\": [\n",
      Quoted(InstructionSetName()).c_str(), Quoted(CeresVersion()).c_str(),
      settings.CpuClock() ? "\"cpu\"" : "\"wall\"", settings.threads, settings.rounds,
      settings.steps, Number(settings.eta).c_str(), Number(settings.time_limit_s).c_str());
  for (std::size_t k = 0; k < problems.size(); ++k) {
    const ProblemRuns& problem = problems[k];
    std::fprintf(file,
                 "  {\"name\": %s, \"cameras\": %d, \"points\": %d, \"observations\": %d,\n"
                 "   \"initial_cost\": %s, \"best_cost\": %s, \"solvers\": [\n",
                 Quoted(problem.name).c_str(), problem.cameras, problem.points,
                 problem.observations, Number(problem.initial_cost).c_str(),
                 Number(problem.BestCost()).c_str());
    for (std::size_t s = 0; s < problem.solvers.size(); ++s) {
      WriteSolver(file, problem, problem.solvers[s]);
      std::fprintf(file, s + 1 < problem.solvers.size() ? ",\n" : "\n");
    }
    std::fprintf(file, k + 1 < problems.size() ? "  ]},\n" : "  ]}\n");
  }
  std::fprintf(file, " ]}\n");
  const bool written = std::ferror(file) == 0;
  return std::fclose(file) == 0 && written;
}

}  // namespace glissade::bench
