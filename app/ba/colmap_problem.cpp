// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/colmap_problem.h"

#include <fmt/format.h>

namespace glissade::app {

void AddColmapChoices(CLI::App& cli, ColmapChoices* choices) {
  CLI::Option* fix = cli.add_flag("--fix-intrinsics", choices->fix_intrinsics,
                                  "COLMAP: hold the cameras' parameters");
  cli.add_flag("--principal-point", choices->free_principal_point,
               "COLMAP: estimate the principal points as well")
      ->excludes(fix);
  cli.add_flag("--colmap-text", choices->text, "COLMAP: write text, not what was read");
}

Result<ColmapProblem> LoadColmap(const std::string& folder, const ColmapChoices& choices,
                                 const Loss& loss, Problem* problem) {
  ColmapProblem colmap;
  const auto format = FindColmapFormat(folder);
  if (!format.ok()) return format.status();
  colmap.format = format.value();
  auto model = ReadColmap(folder);
  if (!model.ok()) return model.status();
  colmap.model = std::move(model).value();
  auto handles = AddToGraph(colmap.model, *problem,
                            {.free_focal_length = !choices.fix_intrinsics,
                             .free_principal_point = choices.free_principal_point,
                             .free_distortion = !choices.fix_intrinsics,
                             .loss = loss});
  if (!handles.ok()) {
    return Status(handles.status().code(),
                  fmt::format("{}: {}", folder, handles.status().message()));
  }
  colmap.handles = std::move(handles).value();
  return colmap;
}

std::string WhatIsLeftOut(const ColmapHandles& handles) {
  std::string text;
  const auto add = [&](std::int64_t count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "left out: " : ", ", count, what);
  };
  add(handles.num_points_left_out, "points that fewer than two images see");
  add(handles.num_images_left_out, "images that see no other point");
  add(handles.num_features_left_out, "features of a point that its image has already");
  return text;
}

}  // namespace glissade::app
