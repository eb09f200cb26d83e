// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"
#include "glissade/graph/graph.h"
#include "glissade/sim/course_scene.h"

namespace glissade::app {

/// Errors against the truth after the similarity transformation (rotation, translation, scale) that
/// takes the estimated camera centres closest to the true ones in least squares (eval::Align). What
/// remains does not depend on where on its gauge orbit a free solution ended. Of three camera
/// centres the transformation explains 7 of 9 numbers, so that the pose error is smaller than that
/// of a solution whose gauge is held at the truth. kInvalidArgument where fewer than three poses,
/// or all on one line, leave it undetermined.
Result<CourseErrors> AlignedErrors(const CourseScene& scene, const Graph& graph,
                                   const CourseHandles& handles);

}  // namespace glissade::app
