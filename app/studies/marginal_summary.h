// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "studies/marginal_walk.h"

namespace glissade::app {

nlohmann::ordered_json ToJson(const WalkFrame& frame);

/// All keyframes of all runs in one gauge and mode.
class WalkSummary {
 public:
  void Add(const std::vector<WalkFrame>& walk);
  [[nodiscard]] bool empty() const { return ms_.empty(); }
  /// A line under PrintWalkHeader().
  void Print(const char* gauge, const char* mode) const;
  [[nodiscard]] nlohmann::ordered_json ToJson(const char* gauge, const char* mode) const;

 private:
  [[nodiscard]] double MedianTime() const;

  double frames_ = 0.0, runs_ = 0.0, cost_ = 0.0, iterations_ = 0.0, rejected_ = 0.0,
         nees_yaw_ = 0.0, nees_position_ = 0.0, drift_ = 0.0;  // sums
  double worst_cost_ = 0.0, worst_turn_ = 0.0, worst_kappa_yaw_ = 0.0, worst_kappa_position_ = 0.0;
  std::vector<double> ms_;
};

void PrintWalkHeader();

}  // namespace glissade::app
