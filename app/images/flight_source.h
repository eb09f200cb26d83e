// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"
#include "glissade/io/euroc.h"
#include "glissade/sim/trajectory.h"
#include "glissade/vision/camera.h"

namespace glissade::app {

/// A flight that images can be rendered of: truth, IMU, cameras.
struct FlightSource {
  std::string origin;
  std::vector<vision::Camera> cameras;  ///< one or two
  bool is_rectified = false;            ///< its cameras say nothing of the lens there was
  std::optional<ImuNoise> imu_noise;    ///< absent: there is no IMU
  double imu_rate_hz = 0.0;
  std::vector<ImuSample> imu;                  ///< stamps increase
  std::vector<GroundTruthState> ground_truth;  ///< at least two; stamps increase
  Vector3 gravity = Vector3(0.0, 0.0, -9.81);  ///< W, m/s^2: what is up, too
};

/// Of a recording with ground truth: VIOTRACKS, or images in a layout that
/// vision::ReadImageRecording knows (the images themselves are not read). The status of the reader;
/// kInvalidArgument where there is no truth, stamps of the IMU do not increase, or cameras are more
/// than two.
[[nodiscard]] Result<FlightSource> ReadFlight(const std::string& folder);

struct SplineOptions {
  sim::TrajectoryKind kind = sim::TrajectoryKind::kRec;
  double lap_m = 15.0;
  double speed_mps = 1.25;
  double seconds = 0.0;  ///< as many laps as that takes; 0: one lap
  std::uint64_t seed = 1;
};

/// As sim::MakeRecording flies it, with its stereo pair and IMU. kInvalidArgument as there.
[[nodiscard]] Result<FlightSource> SimulateFlight(const SplineOptions& options);

}  // namespace glissade::app
