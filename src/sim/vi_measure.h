// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"
#include "glissade/sim/vi_world.h"

namespace glissade::sim::internal {

/// Streams of a seed: what is drawn for one use does not shift what is drawn for another.
enum : std::uint64_t {
  kPixelStream = 10,
  kImuStream = 11,
  kStartStream = 12,
  kTrackStream = 13,
  kLandmarkStream = 14,
};

/// What the IMU of a world reads, and its biases at the keyframes.
struct ImuReadings {
  std::vector<ImuSample> samples;  ///< truth + walking bias + noise
  std::vector<ImuBias> biases;     ///< one per keyframe
};
/// The world must have IMU samples that cover its keyframes, as those of MakeViWorld do.
ImuReadings DrawImuReadings(const ViWorld& world, std::uint64_t seed);

}  // namespace glissade::sim::internal
