// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/eval/trajectory.h"

/// \file
/// Trajectory files. Readers tell by content whether a file is plain, gzip or bzip2, and take it
/// whole or not at all: kIoError, or kParseError with "file:line: what was expected, what was
/// found". Stamps must increase; quaternions are of unit length within 1e-3 (rounded in the file)
/// and normalized. Writers compress where the name ends in .gz or .bz2; the file appears whole or
/// not at all, with as few digits as read back to the same bits. They refuse what
/// eval::ValidateTrajectory refuses, and then write nothing.
namespace glissade {

/// As the TUM RGB-D benchmark has it (Sturm et al., IROS 2012): a line for each pose, "stamp px py
/// pz qx qy qz qw", stamp in seconds, # begins a comment. A stamp is read digit by digit and not as
/// a double, which cannot tell nanoseconds of today apart: 1403636579.763555584 and
/// 1.403636579763555584e9 are 1403636579763555584 ns. Digits beyond the ninth are rounded.
[[nodiscard]] Result<eval::Trajectory> ReadTumTrajectory(const std::string& path);
Status WriteTumTrajectory(std::span<const eval::StampedPose> trajectory, const std::string& path);

/// As the ground truth of the EuRoC MAV data set, in 8 or 17 columns: see ReadEurocGroundTruth,
/// whose poses these are. Written in 8.
[[nodiscard]] Result<eval::Trajectory> ReadEurocTrajectory(const std::string& path);
Status WriteEurocTrajectory(std::span<const eval::StampedPose> trajectory, const std::string& path);

/// Where the stamps of a file without come from: one of the two.
struct KittiStamps {
  /// A file with a time in seconds a line, as many as there are poses (KITTI's times.txt).
  std::string times = {};
  /// Poses per second, from stamp 0 on; 0: not that.
  double rate_hz = 0.0;
};

/// As KITTI's odometry benchmark has it (Geiger et al., CVPR 2012): a line for each pose, the upper
/// 3 x 4 of T_w_b by rows, and no stamp. KITTI's own are those of the left camera in its first
/// pose: z ahead, y down. A rotation must be one within 1e-3. kInvalidArgument where `stamps` has
/// neither or both, or a rate that is not positive; kParseError where the times are fewer or more
/// than the poses.
[[nodiscard]] Result<eval::Trajectory> ReadKittiTrajectory(const std::string& path,
                                                           const KittiStamps& stamps);
/// Stamps go to `times`, where that is a name, and nowhere else: a benchmark has them already. What
/// is read back has the same poses to rounding: matrices are made of quaternions.
Status WriteKittiTrajectory(std::span<const eval::StampedPose> trajectory, const std::string& path,
                            const std::string& times = "");

/// Times in seconds, one a line, that increase; in nanoseconds.
[[nodiscard]] Result<std::vector<std::int64_t>> ReadKittiTimes(const std::string& path);

enum class TrajectoryFormat : std::uint8_t { kTum, kEuroc, kKitti };

/// By the first line that is no comment: EuRoC's where it has a comma, KITTI's where it has 12
/// words, else TUM's. Fails where the file cannot be opened or decompressed.
[[nodiscard]] Result<TrajectoryFormat> FindTrajectoryFormat(const std::string& path);

/// Any of them. `stamps` are asked for KITTI's alone, which is refused without (kInvalidArgument).
[[nodiscard]] Result<eval::Trajectory> ReadTrajectory(const std::string& path,
                                                      const KittiStamps& stamps = {});
/// kitti_times: see WriteKittiTrajectory.
Status WriteTrajectory(std::span<const eval::StampedPose> trajectory, const std::string& path,
                       TrajectoryFormat format, const std::string& kitti_times = "");

}  // namespace glissade
