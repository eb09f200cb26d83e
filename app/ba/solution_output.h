// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ba/colmap_problem.h"
#include "common/status_line.h"
#include "glissade/problem/problem.h"

namespace glissade::app {

/// Where a solution goes, and in which form, by the end of the name:
///     .ply            a picture of points and cameras
///     .txt .gz .bz2 .bbal, of BAL: BAL (.bbal binary, .gz and .bz2 compressed)
///     a folder, or a name that ends in '/': a COLMAP model; of one, any other name
struct SolutionOutput {
  std::string path;
  bool colmap_text = false;  ///< else binary, or what was read
};

/// Refuses what Write would refuse in the end: asked before the solve. colmap: null for BAL.
Status CheckSolutionOutput(const SolutionOutput& output, const ColmapProblem* colmap);

/// Writes what a problem holds.
Status WriteSolution(const Problem& problem, const ColmapProblem* colmap,
                     const SolutionOutput& output, StatusLine* status);

}  // namespace glissade::app
