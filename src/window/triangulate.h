// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "glissade/base/status.h"
#include "glissade/window/triangulate.h"

namespace glissade::internal {

/// Why there is no point, as a Status says it, but without making one: most tracks of most frames
/// have none yet.
struct TriangulationVerdict {
  StatusCode code = StatusCode::kOk;
  const char* what = "";
  double figure = 0.0;
};

/// Triangulate() of two or more views that have been checked.
[[nodiscard]] TriangulationVerdict TryToTriangulate(std::span<const TriangulationView> views,
                                                    const TriangulationOptions& options,
                                                    TriangulatedPoint* point);

}  // namespace glissade::internal
