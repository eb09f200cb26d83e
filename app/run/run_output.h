// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "replay/judge.h"
#include "run/vio_session.h"

namespace glissade::app {

/// What a front end took, and what happened, as text.
void PrintSession(const VioSession& session);

/// "vision": features, events, ms of each stage; beside the keys of vio_replay.
nlohmann::ordered_json SessionJson(const VioSession& session);

struct ReportInput {
  std::string title, origin;
  const VioSession& session;
  const CausalRun& run;
  const std::optional<TrajectoryErrors>& errors;
  const nlohmann::ordered_json& figures;
  bool has_imu;
};
/// The data of WriteReportPage.
nlohmann::ordered_json ReportData(const ReportInput& input);

/// What scripts/rerun_view.py takes: a line of JSON for the session's last frame.
std::string RerunLine(const VioSession& session, const std::string& image);

}  // namespace glissade::app
