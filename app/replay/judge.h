// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "glissade/eval/alignment.h"
#include "glissade/eval/trajectory.h"
#include "glissade/io/viotracks.h"

namespace glissade::app {

/// How far a trajectory is from the truth. Absent: cannot be said, of too short a trajectory say.
struct TrajectoryErrors {
  /// By which the first figure is aligned: about the vertical with an IMU, SE(3) without.
  eval::AlignmentKind alignment = eval::AlignmentKind::kYaw;
  std::optional<double> ate_m, ate_yaw_deg;   ///< RMS, after that alignment
  std::optional<double> ate_se3_m;            ///< RMS, after SE(3) alignment
  std::optional<double> scale_error_percent;  ///< that Sim(3) alignment would take out
  std::optional<double> rpe_1s_m;             ///< RMS over 1 s
  std::optional<double> rpe_percent;          ///< mean over pieces of the way, per distance
  std::optional<double> yaw_drift_deg;        ///< of the last pose, where the first has no error
  double rpe_length_m = 0.0;                  ///< of the pieces for rpe_percent
  double path_m = 0.0;                        ///< of the truth, where there is an estimate
  std::size_t poses = 0;
};

struct JudgeOptions {
  bool has_imu = true;
  double rpe_length_m = 0.0;  ///< 0: DefaultLength
};

/// 100 m, of trajectories shorter than 150 m 10 m, of those shorter than 15 m 1 m.
double DefaultLength(double path_m);

/// The true trajectory, turned so that the vertical is z as in a window's world; empty where the
/// recording has none.
eval::Trajectory ReferenceOf(const Viotracks& recording);

/// Whether the truth is on the clock of the recording's frames, and not on that of its IMU: it has
/// nine tenths of their very stamps. Then a pose is judged at its frame's own stamp, else at that
/// with the offset between the clocks.
bool OnFramesClock(const Viotracks& recording);

TrajectoryErrors Judge(const eval::Trajectory& estimate, const eval::Trajectory& reference,
                       const JudgeOptions& options);

/// "ate_m", ...: as in the JSON file; null for what is absent.
void AddErrors(const TrajectoryErrors& errors, nlohmann::ordered_json* json);

/// "ATE 0.031 m (yaw aligned), ..."
std::string Describe(const TrajectoryErrors& errors);

}  // namespace glissade::app
