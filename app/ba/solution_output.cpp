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

ColmapFormat FormatOf(const SolutionOutput& output, const ColmapProblem* colmap) {
  if (output.colmap_text) return ColmapFormat::kText;
  return colmap != nullptr ? colmap->format : ColmapFormat::kBinary;
}

Status Refused(const SolutionOutput& output, const char* why) {
  return {StatusCode::kInvalidArgument, fmt::format("--output: {}: {}", output.path, why)};
}

}  // namespace

Status CheckSolutionOutput(const SolutionOutput& output, const ColmapProblem* colmap) {
  if (output.path.empty() || output.path.ends_with(".ply")) return {};
  const bool folder = IsFolder(output.path);
  if (colmap == nullptr && !folder) return {};
  if (!folder && IsBalName(output.path))
    return Refused(output, "a COLMAP model is written to a folder, or as .ply");
  std::error_code error;
  if (fs::exists(output.path, error) && !fs::is_directory(output.path, error))
    return Refused(output, "is a file, not a folder");
  const auto there = FindColmapFormat(output.path);
  if (FormatOf(output, colmap) == ColmapFormat::kText && there.ok() &&
      there.value() == ColmapFormat::kBinary) {
    return Refused(output, "has a binary model, which would be read instead of the text");
  }
  return {};
}

Status WriteSolution(const Problem& problem, const ColmapProblem* colmap,
                     const SolutionOutput& output, StatusLine* status) {
  const std::string& path = output.path;
  if (path.ends_with(".ply")) {
    const auto scene = PlyOfGraph(problem);
    return scene.ok() ? WritePly(*scene, path) : scene.status();
  }
  if (colmap != nullptr) {
    ColmapModel solved = colmap->model;
    if (Status s = UpdateFromGraph(problem, colmap->handles, &solved); !s.ok()) return s;
    status->Show("writing " + path);
    return WriteColmap(solved, path, FormatOf(output, colmap));
  }
  const auto solved = BalFromGraph(problem);
  if (!solved.ok()) return solved.status();
  if (IsFolder(path)) {
    const auto model = ColmapFromBal(*solved);
    return model.ok() ? WriteColmap(*model, path, FormatOf(output, colmap)) : model.status();
  }
  return WriteBal(*solved, path, [&](double part) { status->ShowPart("writing " + path, part); });
}

}  // namespace glissade::app
