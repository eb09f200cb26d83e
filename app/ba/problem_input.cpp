// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/problem_input.h"

#include <fmt/format.h>

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
  cli.add_option("FILE", input->file, "BAL problem: .txt, .txt.gz, .txt.bz2, .bbal");
  CLI::Option* city = AddInteger(cli, "--city", &input->city, 20, 20000,
                                 "Instead of FILE: a simulated city seen by N cameras");
  AddSeed(cli, &input->seed, "Seed of the city (default 1)")->needs(city);
}

Status LoadProblem(const ProblemInput& input, const Loss& loss, StatusLine* status,
                   Problem* problem) {
  status->ShowNow(input.city == 0 ? "reading " + input.file : "making a " + input.Name());
  auto bal = input.city == 0 ? ReadBal(input.file)
                             : sim::MakeCity({.num_cameras = input.city, .seed = input.seed});
  if (!bal.ok()) return bal.status();
  Status added = MoveToGraph(std::move(bal).value(), *problem, loss);
  status->Clear();
  if (added.ok()) return added;
  return {added.code(), fmt::format("{}: {}", input.Name(), added.message())};
}

ProblemSize SizeOf(const Problem& problem) {
  return {problem.NumVertices<VertexCameraBal>(), problem.NumVertices<VertexPointXYZ>(),
          problem.NumEdges<EdgeBal>()};
}

std::string WhyNotSolved(const SolveSummary& summary, const Problem& problem) {
  const Status& status = summary.status;
  if (status.code() != StatusCode::kDuplicate) return status.message();
  return fmt::format("observations {} and {} (from 0) are of the same point by the same camera",
                     IndexOf(problem, status.edge()), IndexOf(problem, status.other_edge()));
}

}  // namespace glissade::app
