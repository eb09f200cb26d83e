// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/eval/association.h"
#include "glissade/eval/statistics.h"

namespace glissade::eval {

/// Of one pose of the estimate, in the reference's world.
struct PoseError {
  std::int64_t stamp_ns = 0;
  double translation[3] = {0, 0, 0};  ///< p_est - p_ref, m
  double rotation_deg = 0.0;          ///< |Log(R_ref' R_est)|, 0 to 180
  double yaw_deg = 0.0;  ///< the rotation that R_est R_ref' makes about the vertical, -180 to 180
};

/// Absolute trajectory error (ATE; J. Sturm et al., "A benchmark for the evaluation of RGB-D SLAM
/// systems", IROS 2012): how far the trajectory as a whole is from the reference.
struct AbsoluteErrors {
  Statistics translation_m;  ///< of |p_est - p_ref|; its rmse is what is called the ATE
  Statistics rotation_deg;
  Statistics yaw_deg;  ///< of |yaw|
  std::vector<PoseError> poses;
};

struct AbsoluteErrorOptions {
  /// For the yaw: the vertical, in the reference's coordinates; of any length but 0.
  Vector3 vertical = Vector3(0.0, 0.0, 1.0);
};

/// Of an estimate as it is: align it before (Align, ApplyAlignment). Refused: what
/// MatchedTrajectories::Validate refuses, no pose, a vertical without direction (kInvalidArgument);
/// kNotFinite where squares overflow.
[[nodiscard]] Result<AbsoluteErrors> ComputeAbsoluteErrors(
    const MatchedTrajectories& matched, const AbsoluteErrorOptions& options = {});

}  // namespace glissade::eval
