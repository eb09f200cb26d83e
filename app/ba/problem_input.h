// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "ba/colmap_problem.h"
#include "common/status_line.h"
#include "glissade/losses/loss.h"
#include "glissade/problem/problem.h"

namespace glissade::app {

/// Where a bundle adjustment problem comes from: a BAL file, the folder of a COLMAP model, or a
/// city that is made in memory.
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

/// Puts the problem into an empty graph; by what the file is where it is one. A folder is a COLMAP
/// model, which is kept in `colmap`. The message of what is refused names it.
Status LoadProblem(const ProblemInput& input, const Loss& loss, StatusLine* status,
                   Problem* problem, std::optional<ColmapProblem>* colmap);

struct ProblemSize {
  int images;  ///< of a COLMAP model; of BAL, where each has a camera of its own, 0
  int cameras, points, observations;
};
ProblemSize SizeOf(const Problem& problem);
/// "49 cameras, 7776 points, 31843 observations", or "49 images by 1 camera, ...".
std::string ToString(const ProblemSize& size);

/// Why a solve failed, in the words of the file.
std::string WhyNotSolved(const SolveSummary& summary, const Problem& problem);

}  // namespace glissade::app
