// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What the library knows of its own edges at run time: compiled here, and nowhere else.

#include "glissade/edges/bal.h"
#include "glissade/edges/pose_point.h"
#include "glissade/edges/pose_prior_vec.h"
#include "glissade/edges/relative_pose.h"
#include "glissade/edges/se3_prior.h"

namespace glissade {

template struct internal::EdgeOpsOf<EdgePosePoint>;
template struct internal::EdgeOpsOf<EdgePosePriorVec>;
template struct internal::EdgeOpsOf<EdgeRelativePose>;
template struct internal::EdgeOpsOf<EdgeSE3Prior>;
template struct internal::EdgeOpsOf<EdgeBal>;

}  // namespace glissade
