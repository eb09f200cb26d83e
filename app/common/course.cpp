// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/course.h"

namespace glissade::app {

Result<CourseScene> LoadScene(const std::string& path) {
  return path.empty() ? Result<CourseScene>(MakeCourseScene()) : ReadCourseScene(path);
}

}  // namespace glissade::app
