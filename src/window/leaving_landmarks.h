// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/window/policy.h"

namespace glissade::internal {

/// Adds to the plan the landmarks that one of its marginalized frames sees and no frame with id
/// `seen_since` or newer. The others stay, and lose their observations in frames that go.
void MarginalizeUnseenLandmarks(const WindowView& window, std::int64_t seen_since,
                                WindowPlan* plan);

}  // namespace glissade::internal
