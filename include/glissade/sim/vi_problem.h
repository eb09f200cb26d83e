// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/graph/graph.h"
#include "glissade/imu/imu_factor.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"

/// \file
/// A batch of visual-inertial measurements with truth and start, from a simulation or from a
/// recording: what a study solves in several ways.
namespace glissade::sim {

/// Pinhole without distortion.
struct ViCamera {
  double fx = 460.0, fy = 460.0, cx = 376.0, cy = 240.0;  ///< px
  int width = 752, height = 480;                          ///< px
  double sigma_px = 1.0;                                  ///< that estimators assume
  Pose T_b_c;                                             ///< camera in body
};

struct ViObservation {
  std::int32_t keyframe = 0;
  std::int32_t point = 0;
  std::int32_t camera = 0;
  double u = 0.0, v = 0.0;  ///< px
};

/// States of all keyframes and points.
struct ViStates {
  std::vector<VertexPose> poses;
  std::vector<VertexSpeedBias> speed_biases;
  std::vector<VertexPointXYZ> points;
};

struct ViProblem {
  std::vector<ViCamera> cameras;
  std::vector<std::int64_t> stamps_ns;  ///< of the keyframes
  ViStates truth;                       ///< points may be empty: unknown
  ViStates start;
  std::vector<ViObservation> observations;
  std::vector<ImuFactor> imu;  ///< between keyframes k and k + 1
};

struct ViGraphOptions {
  /// Biases are known: held at the start's values (Fix::kBiases). Else they are states, and need a
  /// prior of yours.
  bool hold_biases = true;
};

/// Where a problem went in a graph.
struct ViHandles {
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<VertexHandle<VertexSpeedBias>> speed_biases;
  std::vector<VertexHandle<VertexPointXYZ>> points;
  std::vector<EdgeHandle<EdgeReprojectionXYZ>> observations;  ///< in their order
  std::vector<EdgeHandle<EdgeImu>> imu;
};

/// Adds vertices at the start's values and all edges to an empty graph. Reprojections are on
/// normalized coordinates with square-root information diag(fx, fy) / sigma_px. Refused: sizes that
/// do not match, indices that do not exist, what the graph refuses; the graph is then to be thrown
/// away.
[[nodiscard]] Result<ViHandles> AddToGraph(const ViProblem& problem, const ViGraphOptions& options,
                                           Graph* graph);

/// The states that the graph holds now.
[[nodiscard]] ViStates StatesOf(const Graph& graph, const ViHandles& handles);

}  // namespace glissade::sim
