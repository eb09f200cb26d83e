// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/base/status.h"
#include "glissade/io/viotracks.h"
#include "glissade/sim/vi_world.h"

namespace glissade::sim {

/// A flight as a front end would have recorded it: IMU, frames of a rectified stereo pair, tracks
/// that end and gross outliers, ground truth at every frame.
struct RecordingOptions {
  /// The flight, points, left camera and IMU. num_keyframes and the start are not used: every
  /// frame is one, and a recording has no start. The seed is that of the points; what is measured
  /// has its own.
  ViWorldOptions world = DefaultWorld();
  double frame_rate_hz = 10.0;
  double baseline_m = 0.11;      ///< right camera along the left one's x axis
  double loss_per_frame = 0.02;  ///< a track ends with this probability, and begins anew
  double outliers = 0.01;        ///< part of the observations that are anywhere in the image
  std::uint64_t seed = 1;

  /// Twelve seconds once around a rectangle of 4.5 x 3 m, 80 points on walls, a good MAV's IMU.
  static ViWorldOptions DefaultWorld();
  [[nodiscard]] Status Validate() const;
};

/// Pixels are rounded to 1e-2, gyroscope to 1e-6 rad/s and accelerometer to 1e-5 m/s^2, far below
/// their noise, so that files of it are small. kInvalidArgument where the options make no sense.
[[nodiscard]] Result<Viotracks> MakeRecording(const RecordingOptions& options);

}  // namespace glissade::sim
