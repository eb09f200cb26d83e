// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "ba/colmap_problem.h"
#include "ba/g2o_input.h"
#include "common/status_line.h"
#include "glissade/losses/loss.h"
#include "glissade/problem/problem.h"

namespace glissade::app {

/// Where a problem comes from: a BAL file, a pose graph of g2o's, the folder of a COLMAP model, or
/// a city that is made in memory.
struct ProblemInput {
  std::string file;
  int city = 0;  ///< cameras; 0: from the file
  std::uint32_t seed = 1;
  ColmapChoices colmap;

  /// The file's name, or "city of 1000 cameras, seed 1".
  [[nodiscard]] std::string Name() const;
  /// Refuses anything but one of the two.
  [[nodiscard]] Status Validate() const;
};

/// FILE, --city, --seed and what is asked of a COLMAP model.
void AddProblemInput(CLI::App& cli, ProblemInput* input);

/// What a problem came from, where that is needed to write it again; neither: BAL.
struct ProblemSource {
  std::optional<ColmapProblem> colmap;
  std::optional<G2oInput> g2o;
};

/// Puts the problem into an empty graph; by what the file is where it is one: a folder is a COLMAP
/// model, a file that begins with a word is one of g2o's. The message of what is refused names it.
Status LoadProblem(const ProblemInput& input, const Loss& loss, StatusLine* status,
                   Problem* problem, ProblemSource* source);

struct ProblemSize {
  int images;  ///< of a COLMAP model; of BAL, where each has a camera of its own, 0
  int poses;   ///< of g2o's: VERTEX_SE3:QUAT
  int cameras, points, observations;
};
ProblemSize SizeOf(const Problem& problem, const ProblemSource& source);
/// "49 cameras, 7776 points, 31843 observations", "49 images by 1 camera, ...", or "2500 poses, 0
/// cameras, 0 points, 4949 edges".
std::string ToString(const ProblemSize& size);

/// Why a solve failed, in the words of the file.
std::string WhyNotSolved(const SolveSummary& summary, const Problem& problem);

}  // namespace glissade::app
