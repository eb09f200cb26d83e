// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ba/problem_input.h"
#include "common/status_line.h"
#include "glissade/problem/problem.h"

namespace glissade::app {

/// Where a solution goes, and in which form, by the end of the name:
///     .ply            a picture of points and cameras
///     .txt .gz .bz2 .bbal, of BAL: BAL (.bbal binary, .gz and .bz2 compressed)
///     .g2o .g2o.gz .g2o.bz2, of g2o's: what was read with its new values
///     a folder, or a name that ends in '/': a COLMAP model; of one, any other name
struct SolutionOutput {
  std::string path;
  bool colmap_text = false;  ///< else binary, or what was read
};

/// Refuses what Write would refuse in the end: asked before the solve.
Status CheckSolutionOutput(const SolutionOutput& output, const ProblemSource& source);

/// Writes what a problem holds.
Status WriteSolution(const Problem& problem, const ProblemSource& source,
                     const SolutionOutput& output, StatusLine* status);

}  // namespace glissade::app
