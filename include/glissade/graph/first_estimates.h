// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace glissade {

/// What is linearized where, once a marginal prior is in the graph. The prior was linearized at
/// some state x_lin of its vertices; linearizing other factors on the same vertices elsewhere gives
/// the sum information about directions that no measurement observes (yaw, for visual-inertial
/// problems). docs/marginalization.md compares the three on a sliding window.
///
/// Source: Huang, Mourikis, Roumeliotis, "A First-Estimates Jacobian EKF for Improving SLAM
/// Consistency" (ISER 2008); kFull as in Usenko et al., "Visual-Inertial Mapping with Non-Linear
/// Factor Recovery" (RA-L 2020).
enum class FirstEstimates : std::uint8_t {
  /// Everything at the present state x. A marginalization moves the old prior to x. For windows
  /// whose first estimates are poor, such as those that do not know their scale yet.
  kOff,
  /// A prior keeps its x0 and a constant Jacobian; factors that a marginalization folds in are
  /// linearized at x_lin; active edges at x. As OKVIS and VINS-Mono do. Only with a gauge that
  /// holds position and yaw of one keyframe (Gauge::Fixed): the prior's cost is not blind to large
  /// turns about the vertical, and a window in the free gauge slides by tens of degrees for it.
  kPriorOnly,
  /// In addition active edges use x_lin for d(relative pose)/d(pose) and for all of the Jacobian
  /// of other edges; d(residual)/d(relative pose), inverse depths, biases, extrinsics and all
  /// residuals stay at x. The null space of gauge-invariant problems is then kept to rounding, in
  /// any gauge. The default.
  kFull,
};

}  // namespace glissade
