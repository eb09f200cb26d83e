// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/builtin_pools.h"

namespace glissade {

template class EdgePool<EdgeSE3Prior>;
template class EdgePool<EdgePosePriorVec>;
template class EdgePool<EdgeRelativePose>;

}  // namespace glissade
