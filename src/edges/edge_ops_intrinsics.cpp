// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What the library knows of its own edges at run time: compiled here, and nowhere else.

#include "glissade/edges/reprojection_intrinsics.h"

namespace glissade {

template struct internal::EdgeOpsOf<EdgeReprojectionRadial>;
template struct internal::EdgeOpsOf<EdgeReprojectionRadtan>;
template struct internal::EdgeOpsOf<EdgeReprojectionFisheye>;

}  // namespace glissade
