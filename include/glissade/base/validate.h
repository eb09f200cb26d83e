// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "glissade/base/status.h"

/// \file
/// Checks at the border, shared by the Validate() of vertices, edges, losses and cameras. `what`
/// begins the message: "extrinsic: quaternion has norm 0.5, not 1".
namespace glissade {

/// kNotFinite when one of n numbers is NaN or infinite; names its index.
Status ValidateFinite(const double* x, int n, std::string_view what);

/// kNotFinite, or kNotPositive when x <= 0.
Status ValidatePositive(double x, std::string_view what);

/// px py pz qx qy qz qw: all finite, and the quaternion of unit length within 1e-6 (else
/// kInvalidArgument).
Status ValidatePose(const double* pose, std::string_view what);

}  // namespace glissade
