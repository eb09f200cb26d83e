// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/covariance/covariance.h"

namespace glissade {

/// The covariance in another gauge, Eqs. (12)-(15) of Zhang et al. (RA-L 2018), in tangents with
/// the rotation in body axes:
///     Cov' = Q D Cov D' Q',   Q = I - U (V'U)^-1 V'
/// D = d(g(x))/dx with the g of Eq. (13), U the gauge directions at g(x), V' the derivative of what
/// the gauge holds. For Gauge::Prior the certainty of the anchor is limited:
/// + 1/weight U (V'U)^-1 (U'V)^-1 U'. Exact where the measurements leave the gauge open at the
/// point of linearization; no inverse or eigenvalue of anything larger than 7 x 7. `cov` may be in
/// any gauge, a prior's too, or be a pseudo-inverse.
///
/// A gauge without a reference of its own leaves the scene where it is (g = 1), like a solve; what
/// yaw means is then what the graph knew of the anchor. Refused (kInvalidArgument): an anchor, or
/// without IMU a second pose for the scale, whose covariance is not in `cov`; Free and FixedPoses.
Result<JointCovariance> TransformCovariance(const JointCovariance& cov, const Gauge& to);

/// The same, and refuses (kInvalidArgument) a `cov` that is not in the gauge `from`: of the same
/// kind, at the same anchor.
Result<JointCovariance> TransformCovariance(const JointCovariance& cov, const Gauge& from,
                                            const Gauge& to);

}  // namespace glissade
