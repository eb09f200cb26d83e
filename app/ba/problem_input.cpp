// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/problem_input.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "common/options.h"
#include "glissade/io/bal.h"
#include "glissade/sim/city.h"

namespace glissade::app {

namespace {

/// Number of a BAL edge in its file, from 0.
std::size_t IndexOf(const Problem& problem, AnyEdge wanted) {
  std::size_t index = 0, found = 0;
  problem.ForEachEdge<EdgeBal>([&](EdgeHandle<EdgeBal> edge, const EdgeBal&) {
    if (AnyEdge(edge) == wanted) found = index;
    ++index;
  });
  return found;
}

}  // namespace

std::string ProblemInput::Name() const {
  return city == 0 ? file : fmt::format("city of {} cameras, seed {}", city, seed);
}

Status ProblemInput::Validate() const {
  if (file.empty() == (city == 0)) {
    return {StatusCode::kInvalidArgument, file.empty()
                                              ? "FILE or --city: one of them is needed"
                                              : "FILE and --city: only one of them can be solved"};
  }
  return {};
}

void AddProblemInput(CLI::App& cli, ProblemInput* input) {
  cli.add_option(
      "FILE", input->file,
      "BAL problem: .txt, .txt.gz, .txt.bz2, .bbal; pose graph of g2o; or the folder of a "
      "COLMAP model");
  CLI::Option* city = AddInteger(cli, "--city", &input->city, 20, 20000,
                                 "Instead of FILE: a simulated city seen by N cameras");
  AddSeed(cli, &input->seed, "the city")->needs(city);
  AddColmapChoices(cli, &input->colmap);
}

Status LoadProblem(const ProblemInput& input, const Loss& loss, StatusLine* status,
                   Problem* problem, ProblemSource* source) {
  status->ShowNow(input.city == 0 ? "reading " + input.file : "making a " + input.Name());
  std::error_code error;
  if (input.city == 0 && std::filesystem::is_directory(input.file, error)) {
    auto loaded = LoadColmap(input.file, input.colmap, loss, problem);
    status->Clear();
    if (!loaded.ok()) return loaded.status();
    source->colmap = std::move(loaded).value();
    return {};
  }
  if (input.colmap.fix_intrinsics || input.colmap.free_principal_point) {
    return {StatusCode::kInvalidArgument,
            "--fix-intrinsics and --principal-point are for COLMAP models"};
  }
  if (input.city == 0 && IsG2o(input.file)) {
    auto loaded = LoadG2o(input.file, loss, problem);
    status->Clear();
    if (!loaded.ok()) return loaded.status();
    source->g2o = std::move(loaded).value();
    return {};
  }
  auto bal = input.city == 0 ? ReadBal(input.file)
                             : sim::MakeCity({.num_cameras = input.city, .seed = input.seed});
  if (!bal.ok()) return bal.status();
  Status added = MoveToGraph(std::move(bal).value(), *problem, loss);
  status->Clear();
  if (added.ok()) return added;
  return {added.code(), fmt::format("{}: {}", input.Name(), added.message())};
}

ProblemSize SizeOf(const Problem& problem, const ProblemSource& source) {
  if (source.g2o) {
    const auto poses = static_cast<int>(source.g2o->handles.poses.size());
    return {0, poses, problem.NumVertices<VertexPose>() - poses,
            problem.NumVertices<VertexPointXYZ>(), problem.NumEdges()};
  }
  const int intrinsics =
      problem.NumVertices<VertexVector<5>>() + problem.NumVertices<VertexVector<8>>();
  return {problem.NumVertices<VertexPose>(), 0, problem.NumVertices<VertexCameraBal>() + intrinsics,
          problem.NumVertices<VertexPointXYZ>(), problem.NumEdges()};
}

std::string ToString(const ProblemSize& size) {
  if (size.poses > 0) {
    return fmt::format("{} poses, {} cameras, {} points, {} edges", size.poses, size.cameras,
                       size.points, size.observations);
  }
  const std::string images = size.images == 0 ? "" : fmt::format("{} images by ", size.images);
  return fmt::format("{}{} camera{}, {} points, {} observations", images, size.cameras,
                     size.cameras == 1 ? "" : "s", size.points, size.observations);
}

std::string WhyNotSolved(const SolveSummary& summary, const Problem& problem) {
  const Status& status = summary.status;
  if (status.code() != StatusCode::kDuplicate || problem.NumEdges<EdgeBal>() == 0)
    return status.message();
  return fmt::format("observations {} and {} (from 0) are of the same point by the same camera",
                     IndexOf(problem, status.edge()), IndexOf(problem, status.other_edge()));
}

}  // namespace glissade::app
