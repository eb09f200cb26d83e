// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "replay/batch.h"
#include "replay/causal_run.h"
#include "replay/consistency.h"
#include "replay/judge.h"

namespace glissade::app {

/// A run as text for people, and as what the JSON file has after its header.
void PrintRun(const CausalRun& run, const std::optional<TrajectoryErrors>& errors);
void PrintConsistency(const std::optional<Consistency>& consistency);
void PrintBatch(const BatchSolution& batch, const std::optional<TrajectoryErrors>& errors);
void AddRun(const CausalRun& run, const std::optional<TrajectoryErrors>& errors,
            nlohmann::ordered_json* json);
nlohmann::ordered_json ToJson(const std::optional<Consistency>& consistency);
nlohmann::ordered_json ToJson(const BatchSolution& batch,
                              const std::optional<TrajectoryErrors>& errors);

/// A table of times, a line for each stage: median, 99th of a hundred, longest.
void PrintTimesHeader(const char* what);
void PrintTimes(const char* name, const std::vector<double>& ms);
/// The same: "median", "p99", "max".
nlohmann::ordered_json QuantilesJson(const std::vector<double>& ms);

/// A line for each estimate; what scripts/plot_trajectory.py draws.
std::string StatesCsv(const CausalRun& run);

}  // namespace glissade::app
