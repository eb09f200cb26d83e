// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/marginal_summary.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/output_file.h"

namespace glissade::app {

namespace {
constexpr double kDegrees = 180.0 / std::numbers::pi;
}  // namespace

nlohmann::ordered_json ToJson(const WalkFrame& f) {
  return {{"frame", f.keyframe},
          {"cost", f.cost},
          {"iterations", f.iterations},
          {"rejected_steps", f.rejected},
          {"time_ms", f.solve_ms},
          {"removed_points", f.removed_points},
          {"yaw_since_linearized_deg", kDegrees * f.yaw_since_linearized},
          {"kappa_yaw", f.kappa_yaw},
          {"kappa_position", f.kappa_position},
          {"yaw_information", f.yaw_information},
          {"nees_yaw", f.nees_yaw},
          {"nees_position", f.nees_position},
          {"drift_m", f.drift_m}};
}

void WalkSummary::Add(const std::vector<WalkFrame>& walk) {
  for (const WalkFrame& f : walk) {
    frames_ += 1.0;
    cost_ += f.cost;
    iterations_ += f.iterations;
    rejected_ += f.rejected;
    nees_yaw_ += f.nees_yaw;
    nees_position_ += f.nees_position;
    ms_.push_back(f.solve_ms);
    worst_cost_ = std::max(worst_cost_, f.cost);
    worst_turn_ = std::max(worst_turn_, std::abs(f.yaw_since_linearized));
    worst_kappa_yaw_ = std::max(worst_kappa_yaw_, f.kappa_yaw);
    worst_kappa_position_ = std::max(worst_kappa_position_, f.kappa_position);
  }
  if (walk.empty()) return;
  runs_ += 1.0;
  drift_ += walk.back().drift_m * walk.back().drift_m;
}

double WalkSummary::MedianTime() const {
  std::vector<double> times = ms_;
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

void PrintWalkHeader() {
  Print("{:<6} {:<10} {:>14} {:>11} {:>6} {:>7} {:>17} {:>12} {:>6}\n", "", "", "cost of a",
        "iterations", "solve", "turned", "largest kappa of", "error^2/cov", "drift");
  Print("{:<6} {:<10} {:>6} {:>7} {:>5} {:>5} {:>6} {:>7} {:>8} {:>8} {:>5} {:>6} {:>6}\n", "gauge",
        "mode", "solve", "largest", "all", "rej.", "ms", "deg", "yaw", "position", "yaw", "pos.",
        "m");
}

void WalkSummary::Print(const char* gauge, const char* mode) const {
  app::Print(
      "{:<6} {:<10} {:>6.1f} {:>7.1f} {:>5.1f} {:>5.1f} {:>6.2f} {:>7.2f} {:>8.1e} {:>8.1e} "
      "{:>5.2f} {:>6.2f} {:>6.2f}\n",
      gauge, mode, cost_ / frames_, worst_cost_, iterations_ / frames_, rejected_ / frames_,
      MedianTime(), kDegrees * worst_turn_, worst_kappa_yaw_, worst_kappa_position_,
      nees_yaw_ / frames_, nees_position_ / frames_, std::sqrt(drift_ / runs_));
}

nlohmann::ordered_json WalkSummary::ToJson(const char* gauge, const char* mode) const {
  return {{"gauge", gauge},
          {"mode", mode},
          {"cost", cost_ / frames_},
          {"largest_cost", worst_cost_},
          {"iterations", iterations_ / frames_},
          {"rejected_steps", rejected_ / frames_},
          {"time_ms", MedianTime()},
          {"turned_deg", kDegrees * worst_turn_},
          {"kappa_yaw", worst_kappa_yaw_},
          {"kappa_position", worst_kappa_position_},
          {"nees_yaw", nees_yaw_ / frames_},
          {"nees_position", nees_position_ / frames_},
          {"drift_m", std::sqrt(drift_ / runs_)}};
}

}  // namespace glissade::app
