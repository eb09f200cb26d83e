// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "common/status_line.h"
#include "glissade/losses/loss.h"
#include "glissade/problem/problem.h"

namespace glissade::app {

/// Where a bundle adjustment problem comes from: a file, or a city that is made in memory.
struct ProblemInput {
  std::string file;
  int city = 0;  ///< cameras; 0: from the file
  std::uint32_t seed = 1;

  /// The file's name, or "city of 1000 cameras, seed 1".
  [[nodiscard]] std::string Name() const;
  /// Refuses anything but one of the two.
  [[nodiscard]] Status Validate() const;
};

/// FILE, --city and --seed.
void AddProblemInput(CLI::App& cli, ProblemInput* input);

/// Puts the problem into an empty graph; by what the file is where it is one. The message of what
/// is refused names it.
Status LoadProblem(const ProblemInput& input, const Loss& loss, StatusLine* status,
                   Problem* problem);

/// "49 cameras, 7776 points, 31843 observations".
struct ProblemSize {
  int cameras, points, observations;
};
ProblemSize SizeOf(const Problem& problem);

/// Why a solve failed, in the words of the file.
std::string WhyNotSolved(const SolveSummary& summary, const Problem& problem);

}  // namespace glissade::app
