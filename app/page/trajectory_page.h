// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "glissade/eval/association.h"

namespace glissade::app {

/// What a page about a trajectory says besides the two of them.
struct TrajectoryPage {
  std::string estimate, reference;  ///< where they were read
  std::string made_by;
  nlohmann::ordered_json figures;  ///< by the names of report_page.h
};

/// The data of a report (report_page.h): an estimate, aligned to the reference already, and the
/// reference at its stamps. Errors are estimate minus reference, along the reference's axes. Times
/// count from the estimate's first pose.
nlohmann::ordered_json PageOf(const TrajectoryPage& page, const eval::MatchedTrajectories& aligned);

}  // namespace glissade::app
