// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "glissade/sim/course_scene.h"

namespace glissade::app {

/// The scene of a file, or where `path` is empty the course's own.
Result<CourseScene> LoadScene(const std::string& path);

}  // namespace glissade::app
