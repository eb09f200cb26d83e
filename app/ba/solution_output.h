// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/status_line.h"
#include "glissade/problem/problem.h"

namespace glissade::app {

/// Writes what a problem holds, in the form that the end of the name says: .ply a picture of points
/// and cameras, else BAL (.bbal binary, .gz and .bz2 compressed).
Status WriteSolution(const Problem& problem, const std::string& path, StatusLine* status);

}  // namespace glissade::app
