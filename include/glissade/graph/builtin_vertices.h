// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// \file
/// Pools of the built-in vertices are compiled once, in the library.

#include "glissade/graph/vertex_pool.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/vertices/vector.h"

namespace glissade {

extern template class VertexPool<VertexPose>;
extern template class VertexPool<VertexInverseDepth>;
extern template class VertexPool<VertexPointXYZ>;
extern template class VertexPool<VertexCameraBal>;
extern template class VertexPool<VertexSpeedBias>;
extern template class VertexPool<VertexVector<1>>;
extern template class VertexPool<VertexVector<2>>;
extern template class VertexPool<VertexVector<3>>;
extern template class VertexPool<VertexVector<4>>;

}  // namespace glissade
