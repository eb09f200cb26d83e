// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"
#include "glissade/io/bal.h"
#include "glissade/io/colmap.h"

namespace glissade {

/// A BAL problem as a COLMAP model, with the same reprojection errors: image, camera (RADIAL) and
/// point k, with id k + 1, are BAL's camera and point k. BAL does not have the size of images: they
/// are as large as the observations need, with the principal point in the middle. Refuses a problem
/// that WriteBal would refuse.
[[nodiscard]] Result<ColmapModel> ColmapFromBal(const BalProblem& bal);

}  // namespace glissade
