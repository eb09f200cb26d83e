// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "page/trajectory_page.h"

#include <filesystem>
#include <utility>

namespace glissade::app {

nlohmann::ordered_json PageOf(const TrajectoryPage& page,
                              const eval::MatchedTrajectories& aligned) {
  using Json = nlohmann::ordered_json;
  const auto name = [](const std::string& path) {
    return std::filesystem::path(path).filename().string();
  };
  Json states, truth;
  for (const char* key : {"t", "p", "q", "error_p"})
    states[key] = Json::array();
  for (const char* key : {"t", "p"})
    truth[key] = Json::array();
  for (std::size_t k = 0; k < aligned.estimate.size(); ++k) {
    const eval::StampedPose& estimate = aligned.estimate[k];
    const double* e = estimate.T_w_b.data;
    const double* r = aligned.reference[k].T_w_b.data;
    const double t =
        1e-9 * static_cast<double>(estimate.stamp_ns - aligned.estimate.front().stamp_ns);
    states["t"].push_back(t);
    states["p"].push_back({e[0], e[1], e[2]});
    states["q"].push_back({e[3], e[4], e[5], e[6]});
    states["error_p"].push_back({e[0] - r[0], e[1] - r[1], e[2] - r[2]});
    truth["t"].push_back(t);
    truth["p"].push_back({r[0], r[1], r[2]});
  }
  return {{"title", name(page.estimate) + " against " + name(page.reference)},
          {"origin", page.estimate},
          {"app_version", page.made_by},
          {"trajectory_only", true},
          {"figures", page.figures},
          {"states", std::move(states)},
          {"truth", std::move(truth)}};
}

}  // namespace glissade::app
