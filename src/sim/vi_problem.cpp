// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/vi_problem.h"

namespace glissade::sim {

Result<ViHandles> AddToGraph(const ViProblem& problem, const ViGraphOptions& options,
                             Graph* graph) {
  const std::size_t n = problem.start.poses.size();
  const auto refused = [](const char* why) {
    return Status(StatusCode::kInvalidArgument, std::string("visual-inertial problem: ") + why);
  };
  if (n == 0 || problem.start.speed_biases.size() != n) {
    return refused("poses and velocities differ in number");
  }
  if (problem.imu.size() + 1 != n) return refused("needs one IMU term between two keyframes");
  ViHandles handles;
  auto poses = graph->AddVertices<VertexPose>(problem.start.poses);
  if (!poses.ok()) return poses.status();
  auto speeds = graph->AddVertices<VertexSpeedBias>(problem.start.speed_biases);
  if (!speeds.ok()) return speeds.status();
  auto points = graph->AddVertices<VertexPointXYZ>(problem.start.points);
  if (!points.ok()) return points.status();
  handles.poses = std::move(poses).value();
  handles.speed_biases = std::move(speeds).value();
  handles.points = std::move(points).value();

  for (const ViObservation& o : problem.observations) {
    const auto k = static_cast<std::size_t>(o.keyframe), j = static_cast<std::size_t>(o.point),
               c = static_cast<std::size_t>(o.camera);
    if (k >= n || j >= handles.points.size() || c >= problem.cameras.size()) {
      return refused("an observation of something that does not exist");
    }
    const ViCamera& camera = problem.cameras[c];
    if (!(camera.fx > 0.0 && camera.fy > 0.0 && camera.sigma_px > 0.0)) {
      return refused("focal length and sigma must be > 0");
    }
    EdgeReprojectionXYZ edge;
    edge.uv = {(o.u - camera.cx) / camera.fx, (o.v - camera.cy) / camera.fy};
    edge.T_b_c = camera.T_b_c;
    Matrix2 sqrt_information = Matrix2::Zero();
    sqrt_information(0, 0) = camera.fx / camera.sigma_px;
    sqrt_information(1, 1) = camera.fy / camera.sigma_px;
    auto added = graph->AddEdge(edge, {handles.poses[k], handles.points[j]},
                                {.sqrt_information = sqrt_information});
    if (!added.ok()) return added.status();
    handles.observations.push_back(added.value());
  }
  for (std::size_t k = 0; k + 1 < n; ++k) {
    auto added = graph->AddEdge(problem.imu[k].edge,
                                {handles.poses[k], handles.speed_biases[k], handles.poses[k + 1],
                                 handles.speed_biases[k + 1]},
                                problem.imu[k].options);
    if (!added.ok()) return added.status();
    handles.imu.push_back(added.value());
  }
  for (const auto& speed : handles.speed_biases) {
    if (!options.hold_biases) break;
    if (Status s = graph->SetFixed(speed, Fix::kBiases); !s.ok()) return s;
  }
  return handles;
}

ViStates StatesOf(const Graph& graph, const ViHandles& handles) {
  ViStates states;
  for (const auto& handle : handles.poses)
    states.poses.push_back(graph.Get(handle));
  for (const auto& handle : handles.speed_biases)
    states.speed_biases.push_back(graph.Get(handle));
  for (const auto& handle : handles.points)
    states.points.push_back(graph.Get(handle));
  return states;
}

}  // namespace glissade::sim
