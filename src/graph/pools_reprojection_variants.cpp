// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/builtin_pools.h"

namespace glissade {

template class EdgePool<EdgeReprojectionStereo>;
template class EdgePool<EdgeReprojectionStereoSame>;
template class EdgePool<EdgeReprojectionTimeOffset>;
template class EdgePool<EdgeReprojectionCalibration>;

}  // namespace glissade
