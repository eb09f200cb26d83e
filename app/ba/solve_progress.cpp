// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/solve_progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace glissade::app {

std::string Duration(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

std::string SolveProgress::After(const IterationSummary& iteration) {
  return fmt::format("iteration {} of at most {}, cost {:.6e}, {}, {} left", iteration.iteration,
                     options_.max_iterations, iteration.cost, Duration(iteration.total_time_s),
                     TimeLeft(iteration));
}

std::string SolveProgress::TimeLeft(const IterationSummary& it) {
  if (it.iteration == 0) return "?";
  const double most = options_.max_iterations - it.iteration;
  const double each = it.total_time_s / it.iteration;
  const double before = decrease_before_;
  const double decrease = it.accepted && it.cost > 0.0 ? it.cost_change / it.cost : 0.0;
  if (it.accepted) decrease_before_ = decrease;
  const double tolerance = options_.cost_tolerance;
  if (tolerance > 0.0 && decrease > tolerance && decrease < before) {
    const double more = std::log(tolerance / decrease) / std::log(decrease / before);
    if (more < most) return "about " + Duration(std::max(1.0, std::ceil(more)) * each);
  }
  return "at most " + Duration(most * each);
}

}  // namespace glissade::app
