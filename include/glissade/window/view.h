// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/base/handle.h"
#include "glissade/base/matrix.h"
#include "glissade/edges/imu.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/lie/pose.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"

/// \file
/// What is in a sliding window, as whoever decides about it sees it.
namespace glissade {

struct WindowFrame {
  std::int64_t id = 0;  ///< frames that a window has taken count from 0
  std::int64_t stamp_ns = 0;
  bool is_keyframe = false;
  Pose T_w_b;  ///< after the last solve, or as predicted
  VertexHandle<VertexPose> pose;
  VertexHandle<VertexSpeedBias> speed_bias;  ///< null: no IMU, or marginalized
  EdgeHandle<EdgeImu> imu;                   ///< the term from the frame before; null: none
  int num_observations = 0;                  ///< in the graph

  [[nodiscard]] bool HasSpeedBias() const { return speed_bias.slot != kNullSlot; }
};

struct LandmarkObservation {
  std::int64_t frame = 0;  ///< id
  int camera = 0;
  Vector2 uv = Vector2::Zero();          ///< (x/z, y/z)
  EdgeHandle<EdgeReprojectionXYZ> edge;  ///< null: not in the graph
};

/// A track: a landmark of the graph once its point is known.
struct WindowLandmark {
  std::int64_t track = 0;
  VertexHandle<VertexPointXYZ> point;             ///< null: not yet triangulated
  std::vector<LandmarkObservation> observations;  ///< by frames of the window, oldest first

  [[nodiscard]] bool InGraph() const { return point.slot != kNullSlot; }
  /// Id of the newest frame that sees it, -1 where there is none.
  [[nodiscard]] std::int64_t NewestFrame() const {
    return observations.empty() ? -1 : observations.back().frame;
  }
};

/// Read-only, valid until the window is changed.
struct WindowView {
  std::span<const WindowFrame> frames;        ///< oldest first
  std::span<const WindowLandmark> landmarks;  ///< in no order, but always in the same
};

}  // namespace glissade
