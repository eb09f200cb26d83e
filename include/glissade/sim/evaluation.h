// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"
#include "glissade/sim/vi_problem.h"

namespace glissade::sim {

/// The rotation by `yaw` about world z and the translation t: x' = Rz x + t.
struct YawTranslation {
  double yaw = 0.0;         ///< rad
  double t[3] = {0, 0, 0};  ///< m
};

/// Takes an estimated pose to where its position is that of the true one, and its rotation differs
/// from the true one by none about world z: the z part of the quaternion of Rz R R_true' is 0
/// (Zhang et al., RA-L 2018, Eq. 13 with R_0^0 the true rotation).
[[nodiscard]] YawTranslation AlignPose(const VertexPose& estimate, const VertexPose& truth);

/// Poses, velocities and points moved; biases stay.
[[nodiscard]] ViStates Moved(const ViStates& states, const YawTranslation& motion);

/// Root mean squares over all keyframes.
struct ViErrors {
  double position_m = 0.0;
  double rotation_deg = 0.0;  ///< of the angle of the rotation between truth and estimate
  double velocity_mps = 0.0;
};

/// Errors after AlignPose of the first keyframe: the protocol of Zhang et al. kInvalidArgument
/// where the two differ in number, or there are none.
[[nodiscard]] Result<ViErrors> AlignedErrors(const ViStates& estimate, const ViStates& truth);

/// The largest differences between two estimates of the same things: of a position coordinate (m),
/// of a rotation (rad), of a velocity coordinate (m/s).
struct ViDifference {
  double position_m = 0.0;
  double rotation_rad = 0.0;
  double velocity_mps = 0.0;
};
[[nodiscard]] ViDifference Difference(const ViStates& a, const ViStates& b);
/// The same after AlignPose of the first keyframe of each to `truth`.
[[nodiscard]] ViDifference AlignedDifference(const ViStates& a, const ViStates& b,
                                             const ViStates& truth);

}  // namespace glissade::sim
