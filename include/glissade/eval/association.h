// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "glissade/base/status.h"
#include "glissade/eval/trajectory.h"

namespace glissade::eval {

enum class AssociationKind : std::uint8_t {
  /// A pose of the estimate and one of the reference that are each other's nearest in time (the
  /// earlier one of two that are as near).
  kNearest,
  /// The reference is interpolated at the estimate's stamps, never extrapolated.
  kInterpolated,
};

struct AssociationOptions {
  AssociationKind kind = AssociationKind::kInterpolated;
  /// kNearest: the most that the two stamps may differ by.
  std::int64_t tolerance_ns = 10'000'000;
  /// kInterpolated: the most that the two neighbours in the reference may be apart. A stamp of the
  /// reference itself needs no neighbours.
  std::int64_t max_gap_ns = 1'000'000'000;
  /// Added to the estimate's stamps before they are compared. The result has the estimate's own.
  std::int64_t offset_ns = 0;

  /// kInvalidArgument where a limit is negative.
  [[nodiscard]] Status Validate() const;
};

/// An estimate and the reference at the same times: as many poses in both, pose by pose.
struct MatchedTrajectories {
  Trajectory estimate;
  Trajectory reference;  ///< has the estimate's stamps

  /// kInvalidArgument where they differ in number or in stamps, else ValidateTrajectory of both.
  [[nodiscard]] Status Validate() const;
};

/// The poses of the estimate that have a counterpart in the reference, with it; each pose of either
/// is used at most once. Refused: what ValidateTrajectory refuses, options that make no sense, and
/// trajectories without a single pair (kInvalidArgument, with the times that the two cover).
[[nodiscard]] Result<MatchedTrajectories> Associate(std::span<const StampedPose> estimate,
                                                    std::span<const StampedPose> reference,
                                                    const AssociationOptions& options = {});

/// The pose at a stamp: the trajectory's own or interpolated between two that are at most
/// max_gap_ns apart, never extrapolated; nothing otherwise. Stamps must not decrease.
[[nodiscard]] std::optional<Pose> PoseAt(std::span<const StampedPose> trajectory,
                                         std::int64_t stamp_ns, std::int64_t max_gap_ns);

}  // namespace glissade::eval
