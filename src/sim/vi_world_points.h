// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/sim/vi_world.h"

namespace glissade::sim::internal {

/// Draws the points of a world, and fills truth.points and observations (exact, keyframe by
/// keyframe).
Status AddPoints(const ViWorldOptions& options, const Trajectory& path, ViProblem* exact);

}  // namespace glissade::sim::internal
