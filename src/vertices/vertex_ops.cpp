// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What the library knows of its own vertices at run time: compiled here, and nowhere else.

#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/vertices/vector.h"

namespace glissade {

template struct internal::VertexOpsOf<VertexPose>;
template struct internal::VertexOpsOf<VertexInverseDepth>;
template struct internal::VertexOpsOf<VertexPointXYZ>;
template struct internal::VertexOpsOf<VertexCameraBal>;
template struct internal::VertexOpsOf<VertexSpeedBias>;
template struct internal::VertexOpsOf<VertexVector<1>>;
template struct internal::VertexOpsOf<VertexVector<2>>;
template struct internal::VertexOpsOf<VertexVector<3>>;
template struct internal::VertexOpsOf<VertexVector<4>>;
template struct internal::VertexOpsOf<VertexVector<5>>;
template struct internal::VertexOpsOf<VertexVector<8>>;

}  // namespace glissade
