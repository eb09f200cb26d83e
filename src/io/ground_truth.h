// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "glissade/base/status.h"
#include "glissade/io/euroc.h"

namespace glissade::internal {

/// What ReadEurocGroundTruth would not take back, or not as it is.
Status CheckGroundTruth(std::span<const GroundTruthState> states);

}  // namespace glissade::internal
