// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What the library knows of its own edges at run time: compiled here, and nowhere else.

#include "glissade/edges/reprojection.h"
#include "glissade/edges/reprojection_calibration.h"
#include "glissade/edges/reprojection_extrinsic.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_stereo_same.h"
#include "glissade/edges/reprojection_time_offset.h"
#include "glissade/edges/reprojection_xyz.h"

namespace glissade {

template struct internal::EdgeOpsOf<EdgeReprojection>;
template struct internal::EdgeOpsOf<EdgeReprojectionExtrinsic>;
template struct internal::EdgeOpsOf<EdgeReprojectionXYZ>;
template struct internal::EdgeOpsOf<EdgeReprojectionStereo>;
template struct internal::EdgeOpsOf<EdgeReprojectionStereoSame>;
template struct internal::EdgeOpsOf<EdgeReprojectionTimeOffset>;
template struct internal::EdgeOpsOf<EdgeReprojectionCalibration>;

}  // namespace glissade
