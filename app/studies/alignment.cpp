// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/alignment.h"

#include <cmath>
#include <cstdint>

#include "glissade/eval/alignment.h"

namespace glissade::app {

Result<CourseErrors> AlignedErrors(const CourseScene& scene, const Graph& graph,
                                   const CourseHandles& handles) {
  eval::MatchedTrajectories matched;
  for (std::size_t k = 0; k < scene.poses.size(); ++k) {
    const auto stamp = static_cast<std::int64_t>(k);
    matched.estimate.push_back({stamp, graph.Get(handles.poses[k]).pose});
    matched.reference.push_back({stamp, scene.poses[k]});
  }
  eval::AlignmentOptions options;
  options.kind = eval::AlignmentKind::kSim3;
  const auto alignment = eval::Align(matched, options);
  if (!alignment.ok()) {
    return Status(StatusCode::kInvalidArgument,
                  "without priors the scene can only be compared to the truth if it has three "
                  "poses that are not on one line");
  }
  CourseErrors errors;
  for (std::size_t k = 0; k < scene.poses.size(); ++k) {
    const Pose moved = alignment->Apply(matched.estimate[k].T_w_b);
    errors.pose += (moved.p() - scene.poses[k].p()).norm();
  }
  for (std::size_t k = 0; k < scene.points.size(); ++k) {
    const double rho = graph.Get(handles.points[k]).rho / alignment->scale;
    errors.point += std::abs(rho - scene.TrueInverseDepth(scene.points[k]));
  }
  return errors;
}

}  // namespace glissade::app
