// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

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

/// One or the other: EuRoC's where the first line that is no comment has a comma.
[[nodiscard]] Result<eval::Trajectory> ReadTrajectory(const std::string& path);

}  // namespace glissade
