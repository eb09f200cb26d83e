// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/builtin_pools.h"

namespace glissade {

template class EdgePool<EdgeImu>;
template class EdgePool<EdgeSpeedBiasPrior>;

}  // namespace glissade
