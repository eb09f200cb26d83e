// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "glissade/minimizer/options.h"
#include "glissade/sim/course_scene.h"

namespace glissade::app {

/// The course's Levenberg-Marquardt: lambda I on the pose block after elimination, Nielsen's
/// update, lambda0 = 1e-5 max diag(H). Run until the step is 1e-10 of the state: no rule on the
/// cost, since this damping can make steps small far from the optimum.
SolveOptions CourseLm();

/// The scene of a file, or where `path` is empty the course's own.
Result<CourseScene> LoadScene(const std::string& path);

/// "dense" or "pcg"; kInvalidArgument for anything else.
Status SetLinearSolver(const std::string& name, SolveOptions* options);

}  // namespace glissade::app
