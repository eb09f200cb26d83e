// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "glissade/io/viotracks.h"
#include "glissade/sim/vi_problem.h"

namespace glissade::app {

struct VioSegmentOptions {
  double start_s = 40.0;  ///< after the first frame
  int num_keyframes = 30;
  int frame_step = 3;         ///< every third frame is a keyframe
  int num_points = 150;       ///< the longest tracks
  double max_error_px = 4.0;  ///< observations that fit the truth worse are outliers, and left out
};

/// A piece of a recording as a batch problem: IMU terms at the true biases, observations without
/// gross outliers, points triangulated from the true poses; start = truth. Refused: a recording
/// without IMU or without true velocities and biases, or one that is too short.
Result<sim::ViProblem> MakeVioSegment(const Viotracks& recording, const VioSegmentOptions& options);

struct VioStartOptions {
  double position_m = 0.05;    ///< length of a random vector
  double rotation_deg = 6.0;   ///< angle about a random axis
  double velocity_mps = 0.05;  ///< uniform on either side, each axis
  double point_m = 0.075;      ///< uniform on either side, each axis
};

/// The segment from another start: as in sim::Measure.
sim::ViProblem WithStart(const sim::ViProblem& segment, const VioStartOptions& options,
                         std::uint64_t seed);

}  // namespace glissade::app
