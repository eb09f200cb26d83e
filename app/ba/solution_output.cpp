// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/solution_output.h"

#include "glissade/io/bal.h"
#include "glissade/io/ply.h"

namespace glissade::app {

Status WriteSolution(const Problem& problem, const std::string& path, StatusLine* status) {
  if (path.ends_with(".ply")) {
    const auto scene = PlyOfGraph(problem);
    return scene.ok() ? WritePly(*scene, path) : scene.status();
  }
  const auto solved = BalFromGraph(problem);
  if (!solved.ok()) return solved.status();
  return WriteBal(*solved, path, [&](double part) { status->ShowPart("writing " + path, part); });
}

}  // namespace glissade::app
