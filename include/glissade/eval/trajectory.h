// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/lie/pose.h"

/// \file
/// Trajectories that are judged, and those that they are judged by.
namespace glissade::eval {

struct StampedPose {
  std::int64_t stamp_ns = 0;
  Pose T_w_b;  ///< body in the trajectory's own world

  friend bool operator==(const StampedPose&, const StampedPose&) = default;
};

using Trajectory = std::vector<StampedPose>;

/// Stamps that increase (else kInvalidArgument), numbers that are finite (kNotFinite), quaternions
/// of unit length within 1e-6 (kInvalidArgument). The message begins with `what` and names the pose
/// by its position in the trajectory, from 0.
[[nodiscard]] Status ValidateTrajectory(std::span<const StampedPose> trajectory,
                                        std::string_view what);

/// Sum of the distances between neighbours, m. 0 for fewer than two poses.
[[nodiscard]] double PathLength(std::span<const StampedPose> trajectory);

/// The pose between two neighbours at a stamp from a.stamp_ns to b.stamp_ns, where
/// a.stamp_ns < b.stamp_ns: position linear in time, rotation by slerp along the shorter way,
/// q_a Exp(u Log(q_a^-1 q_b)). What lies outside is clamped to a and b.
[[nodiscard]] StampedPose Interpolate(const StampedPose& a, const StampedPose& b,
                                      std::int64_t stamp_ns);

}  // namespace glissade::eval
