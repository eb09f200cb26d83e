// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/solution_output.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "glissade/io/bal.h"
#include "glissade/io/colmap_bal.h"
#include "glissade/io/ply.h"

namespace glissade::app {

namespace {

namespace fs = std::filesystem;

bool IsBalName(const std::string& path) {
  return path.ends_with(".txt") || path.ends_with(".gz") || path.ends_with(".bz2") ||
         path.ends_with(".bbal");
}

bool IsFolder(const std::string& path) {
  std::error_code error;
  return path.ends_with('/') || fs::is_directory(path, error);
}

ColmapFormat FormatOf(const SolutionOutput& output, const ProblemSource& source) {
  if (output.colmap_text) return ColmapFormat::kText;
  return source.colmap ? source.colmap->format : ColmapFormat::kBinary;
}

Status Refused(const SolutionOutput& output, const char* why) {
  return {StatusCode::kInvalidArgument, fmt::format("--output: {}: {}", output.path, why)};
}

}  // namespace

Status CheckSolutionOutput(const SolutionOutput& output, const ProblemSource& source) {
  if (output.path.empty()) return {};
  if (source.g2o.has_value() != IsG2oName(output.path)) {
    return Refused(output, source.g2o ? "what comes from g2o's file is written as .g2o"
                                      : "only what comes from g2o's file is written as such");
  }
  if (source.g2o || output.path.ends_with(".ply")) return {};
  const bool folder = IsFolder(output.path);
  if (!source.colmap && !folder) return {};
  if (!folder && IsBalName(output.path))
    return Refused(output, "a COLMAP model is written to a folder, or as .ply");
  std::error_code error;
  if (fs::exists(output.path, error) && !fs::is_directory(output.path, error))
    return Refused(output, "is a file, not a folder");
  const auto there = FindColmapFormat(output.path);
  if (FormatOf(output, source) == ColmapFormat::kText && there.ok() &&
      there.value() == ColmapFormat::kBinary) {
    return Refused(output, "has a binary model, which would be read instead of the text");
  }
  return {};
}

Status WriteSolution(const Problem& problem, const ProblemSource& source,
                     const SolutionOutput& output, StatusLine* status) {
  const std::string& path = output.path;
  if (path.ends_with(".ply")) {
    const auto scene = PlyOfGraph(problem);
    return scene.ok() ? WritePly(*scene, path) : scene.status();
  }
  if (source.g2o) {
    G2oProblem solved = source.g2o->problem;
    if (Status s = UpdateFromGraph(problem, source.g2o->handles, &solved); !s.ok()) return s;
    status->Show("writing " + path);
    return WriteG2o(solved, path);
  }
  if (source.colmap) {
    ColmapModel solved = source.colmap->model;
    if (Status s = UpdateFromGraph(problem, source.colmap->handles, &solved); !s.ok()) return s;
    status->Show("writing " + path);
    return WriteColmap(solved, path, FormatOf(output, source));
  }
  const auto solved = BalFromGraph(problem);
  if (!solved.ok()) return solved.status();
  if (IsFolder(path)) {
    const auto model = ColmapFromBal(*solved);
    return model.ok() ? WriteColmap(*model, path, FormatOf(output, source)) : model.status();
  }
  return WriteBal(*solved, path, [&](double part) { status->ShowPart("writing " + path, part); });
}

}  // namespace glissade::app
