// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/minimizer/summary.h"

#include <cstdio>

namespace glissade {

std::string_view ToString(Termination termination) {
  switch (termination) {
    case Termination::kConvergedCost:
      return "converged (cost)";
    case Termination::kConvergedGradient:
      return "converged (gradient)";
    case Termination::kConvergedStep:
      return "converged (step)";
    case Termination::kConvergedFirstEstimates:
      return "converged (first estimates: only rejected steps)";
    case Termination::kMaxIterations:
      return "iteration limit";
    case Termination::kMaxTime:
      return "time limit";
    case Termination::kCancelled:
      return "cancelled by callback";
    case Termination::kNoProgress:
      return "no progress";
    case Termination::kFailed:
      return "failed";
  }
  return "unknown";
}

std::string IterationTableHeader() {
  return "iter        cost      change    gradient        step    gain    lambda  lin    time [ms]";
}

std::string ToString(const IterationSummary& it) {
  char line[160];
  std::snprintf(line, sizeof(line), "%4d%c %11.6e %10.2e %10.2e %10.2e %8.3f %9.2e %4d %10.3f",
                it.iteration, it.accepted ? ' ' : 'x', it.cost, it.cost_change, it.gradient_max,
                it.step_norm, it.gain_ratio, it.lambda, it.linear_iterations, 1e3 * it.time_s);
  return line;
}

std::string SolveSummary::BriefReport() const {
  char numbers[160];
  std::snprintf(numbers, sizeof(numbers), ", %d iterations, cost %.6g -> %.6g, %.3f ms",
                accepted_steps + rejected_steps, initial_cost, final_cost, 1e3 * time.total_s);
  std::string report(ToString(termination));
  if (!status.ok()) report += ": " + status.message();
  report += numbers;
  if (num_threads_refused > 0) {
    report += ", " + std::to_string(num_threads) + " threads (the system refused " +
              std::to_string(num_threads_refused) + ")";
  }
  return report;
}

}  // namespace glissade
