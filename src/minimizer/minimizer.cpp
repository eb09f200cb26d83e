// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/minimizer/minimizer.h"

#include <algorithm>
#include <new>
#include <utility>

#include "minimizer/loop.h"

namespace glissade {

namespace {

void Reset(const SolveOptions& options, SolveSummary* summary) {
  // In place, so that the storage of the last summary serves again.
  std::vector<IterationSummary> iterations = std::move(summary->iterations);
  std::vector<EdgeEvaluation> edges = std::move(summary->edges);
  iterations.clear();
  edges.clear();
  *summary = {};
  summary->iterations = std::move(iterations);
  summary->edges = std::move(edges);
  summary->iterations.reserve(
      static_cast<std::size_t>(std::clamp(options.max_iterations, 0, 4095)) + 1);
}

void Run(Graph* graph, SolverWorkspace* workspace, const SolveOptions& options,
         Clock::time_point start) {
  workspace->Restore();
  workspace->equations.ForgetRedonePacks();
  RelativeRules relative(options, *graph, *workspace);
  CourseRules course;
  StoppingRules* rules = &relative;
  if (options.course_stop) rules = &course;
  const auto run = [&](StepStrategy&& strategy) {
    Minimizer(graph, workspace, options, &strategy, rules, start).Run();
  };
  if (options.method == Method::kDogleg) {
    run(DoglegStrategy(graph, workspace, options, start));
  } else if (options.damping == Damping::kPoseBlock) {
    run(CourseStrategy(graph, workspace, options, start));
  } else {
    run(LevenbergMarquardtStrategy(graph, workspace, options, start));
  }
  // Only of what this solve has analyzed.
  SolveSummary& summary = workspace->summary;
  if (summary.num_edges > 0)
    workspace->equations.ListEvaluations(workspace->structure, *graph, &summary.edges);
}

}  // namespace

const SolveSummary& Solve(Graph* graph, SolverWorkspace* workspace, const SolveOptions& options) {
  const Clock::time_point start = Clock::now();
  SolveSummary& summary = workspace->summary;
  // Messages of up to 15 characters need no memory.
  const auto fail = [&](StatusCode code, const char* what) {
    summary.status = {code, what};
    summary.termination = Termination::kFailed;
    workspace->Discard();
  };
  try {
    Reset(options, &summary);
    Run(graph, workspace, options, start);
  } catch (const std::bad_alloc&) {
    fail(StatusCode::kOutOfMemory, "out of memory");
  } catch (...) {
    fail(StatusCode::kEvaluationFailed, "user code threw");
    throw;
  }
  summary.time.total_s = SecondsSince(start);
  return summary;
}

}  // namespace glissade
