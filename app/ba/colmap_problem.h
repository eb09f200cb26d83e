// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "glissade/io/colmap_graph.h"
#include "glissade/problem/problem.h"

namespace glissade::app {

/// What is asked of a COLMAP model.
struct ColmapChoices {
  bool free_principal_point = false;
  bool fix_intrinsics = false;
  bool text = false;  ///< write as text
};

/// --principal-point, --fix-intrinsics and --colmap-text.
void AddColmapChoices(CLI::App& cli, ColmapChoices* choices);

/// A model that is being solved.
struct ColmapProblem {
  ColmapModel model;
  ColmapHandles handles;
  ColmapFormat format = ColmapFormat::kBinary;  ///< in which it came
};

/// Puts the model in a folder into an empty graph.
Result<ColmapProblem> LoadColmap(const std::string& folder, const ColmapChoices& choices,
                                 const Loss& loss, Problem* problem);

/// "left out: 3 points that fewer than two images see, 1 image"; empty where nothing is.
std::string WhatIsLeftOut(const ColmapHandles& handles);

}  // namespace glissade::app
