// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// \file
/// Pools of the built-in types are compiled once, in the library. Including this header keeps a
/// consumer's translation unit from compiling them again.

#include "glissade/edges/bal.h"
#include "glissade/edges/imu.h"
#include "glissade/edges/pose_prior_vec.h"
#include "glissade/edges/relative_pose.h"
#include "glissade/edges/reprojection.h"
#include "glissade/edges/reprojection_calibration.h"
#include "glissade/edges/reprojection_extrinsic.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_stereo_same.h"
#include "glissade/edges/reprojection_time_offset.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/edges/se3_prior.h"
#include "glissade/edges/speed_bias_prior.h"
#include "glissade/graph/builtin_vertices.h"
#include "glissade/graph/edge_pool.h"

namespace glissade {

extern template class EdgePool<EdgeReprojection>;
extern template class EdgePool<EdgeReprojectionExtrinsic>;
extern template class EdgePool<EdgeReprojectionXYZ>;
extern template class EdgePool<EdgeReprojectionStereo>;
extern template class EdgePool<EdgeReprojectionStereoSame>;
extern template class EdgePool<EdgeReprojectionTimeOffset>;
extern template class EdgePool<EdgeReprojectionCalibration>;
extern template class EdgePool<EdgeSE3Prior>;
extern template class EdgePool<EdgePosePriorVec>;
extern template class EdgePool<EdgeRelativePose>;
extern template class EdgePool<EdgeBal>;
extern template class EdgePool<EdgeImu>;
extern template class EdgePool<EdgeSpeedBiasPrior>;

}  // namespace glissade
