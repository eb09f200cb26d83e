// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/builtin_pools.h"

namespace glissade {

template class EdgePool<EdgeBal>;
template class VertexPool<VertexPose>;
template class VertexPool<VertexInverseDepth>;
template class VertexPool<VertexPointXYZ>;
template class VertexPool<VertexCameraBal>;
template class VertexPool<VertexSpeedBias>;
template class VertexPool<VertexVector<1>>;
template class VertexPool<VertexVector<2>>;
template class VertexPool<VertexVector<3>>;
template class VertexPool<VertexVector<4>>;

}  // namespace glissade
