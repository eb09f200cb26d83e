// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"
#include "glissade/eval/alignment.h"
#include "glissade/sim/vi_problem.h"

namespace glissade::sim {

/// Poses, velocities and points moved to where an alignment by a rigid motion (its scale is not
/// used) takes them; biases stay.
[[nodiscard]] ViStates Moved(const ViStates& states, const eval::Alignment& motion);

/// Root mean squares over all keyframes.
struct ViErrors {
  double position_m = 0.0;
  double rotation_deg = 0.0;  ///< of the angle of the rotation between truth and estimate
  double velocity_mps = 0.0;
};

/// Errors after eval::AlignPose of the first keyframe: the protocol of Zhang et al.
/// kInvalidArgument where the two differ in number, or there are none.
[[nodiscard]] Result<ViErrors> AlignedErrors(const ViStates& estimate, const ViStates& truth);

/// The largest differences between two estimates of the same things: of a position coordinate (m),
/// of a rotation (rad), of a velocity coordinate (m/s).
struct ViDifference {
  double position_m = 0.0;
  double rotation_rad = 0.0;
  double velocity_mps = 0.0;
};
[[nodiscard]] ViDifference Difference(const ViStates& a, const ViStates& b);
/// The same after eval::AlignPose of the first keyframe of each to `truth`.
[[nodiscard]] ViDifference AlignedDifference(const ViStates& a, const ViStates& b,
                                             const ViStates& truth);

}  // namespace glissade::sim
