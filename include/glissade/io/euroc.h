// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/imu/sample.h"
#include "glissade/lie/pose.h"
#include "glissade/vertices/speed_bias.h"

/// \file
/// The CSV files of the EuRoC MAV data set (Burri et al., IJRR 2016): imu0/data.csv,
/// state_groundtruth_estimate0/data.csv, cam0/data.csv. Plain or compressed (told by content). All
/// or nothing: on failure kIoError, or kParseError with "file:line: what".
namespace glissade {

/// How much of a recording is judged while it is read.
enum class Reading : std::uint8_t {
  kChecked,     ///< what makes no sense is refused
  kAsRecorded,  ///< NaN, infinite values and any order of stamps are handed on: for the data doctor
};

struct GroundTruthState {
  std::int64_t stamp_ns = 0;
  Pose T_w_b;
  /// In our order [v, ba, bg], whatever the file's is; absent where the file has poses only.
  std::optional<VertexSpeedBias> speed_bias;
};

/// timestamp_ns, wx, wy, wz, ax, ay, az. Order of time is not judged here but by ImuBuffer.
[[nodiscard]] Result<std::vector<ImuSample>> ReadEurocImu(const std::string& path,
                                                          Reading reading = Reading::kChecked);

/// timestamp_ns, px, py, pz, qw, qx, qy, qz [, vx, vy, vz, bgx, bgy, bgz, bax, bay, baz]: mind the
/// order, w first and the gyroscope's bias before the accelerometer's. Stamps increase;
/// quaternions are of unit length within 1e-3 (rounded in the file) and normalized.
[[nodiscard]] Result<std::vector<GroundTruthState>> ReadEurocGroundTruth(const std::string& path);

/// Writes such a file, compressed if the name ends in .gz or .bz2; numbers have as few digits as
/// read back to the same bits. It appears whole or not at all. Refused, and nothing written: stamps
/// that do not increase, poses that are none, numbers that are not finite, speeds and biases at
/// some stamps only.
Status WriteEurocGroundTruth(std::span<const GroundTruthState> states, const std::string& path);

/// timestamp_ns [, file name]: stamps of a camera, which increase where that is checked.
[[nodiscard]] Result<std::vector<std::int64_t>> ReadEurocStamps(
    const std::string& path, Reading reading = Reading::kChecked);

}  // namespace glissade
