// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/gauge_covariance.h"
#include "studies/gauge_experiments.h"

namespace glissade::app {

struct GaugeRealResult {
  std::string dataset;
  GaugeConfiguration configuration;
  GaugeCovariances covariance;
};

/// Everything that a run of gauge_study has found.
struct GaugeStudy {
  GaugeStudyOptions options;
  std::vector<GaugeConfiguration> configurations;
  std::string sweep_configuration;  ///< of weights, paths and covariance
  std::vector<GaugeWeight> weights;
  std::vector<GaugePath> paths;
  std::vector<GaugeCovariances> covariance;  ///< one or none
  std::vector<GaugeRealResult> real;
};

/// Tables for people.
void PrintStudy(const GaugeStudy& study);
/// Errors are means, iterations and times medians over the trials. The same bytes for the same
/// numbers, apart from those named time_ms.
nlohmann::ordered_json ToJson(const GaugeStudy& study);
/// One line per configuration or weight, method and trial.
std::string ToCsv(const GaugeStudy& study);

}  // namespace glissade::app
