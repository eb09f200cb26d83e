// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/minimizer/solver_choice.h"

#include <initializer_list>
#include <string>
#include <string_view>

#include "glissade/graph/pools.h"
#include "glissade/minimizer/minimizer.h"

namespace glissade {

namespace {

/// With more of the blocks than this there is nothing to gain from leaving some out.
constexpr double kDenseFraction = 0.8;
/// Small fronts run at about a third of the speed of one dense factorization.
constexpr double kWorthwhile = 0.3;
/// One dense factorization of so many scalars takes less than the symbolic analysis of a sparse
/// one.
constexpr int kSmall = 128;

/// Rates that the choice between factorizing and iterating rests on, of one thread; only their
/// ratio matters.
constexpr double kFlopsPerSecond = 2e10;   // of a sparse factorization
constexpr double kSecondsPerEdge = 2e-7;   // of linearizing and eliminating
constexpr double kMaxFactorization = 3.0;  // times as long as linearizing and eliminating

std::string Megabytes(std::int64_t bytes) {
  return std::to_string((bytes + 999'999) / 1'000'000);
}

/// kAuto's choice without a limit.
LinearSolverType Preferred(SolverWorkspace* w, const char** reason) {
  const Structure& structure = w->structure;
  if (structure.num_pose_scalars() <= kSmall) {
    *reason = "few scalars";
    return LinearSolverType::kDenseCholesky;
  }
  const SchurLayout& layout = w->equations.ReducedLayout(structure);
  const auto n = static_cast<double>(layout.num_vertices());
  const auto scalars = static_cast<double>(layout.size());
  const double affordable = kMaxFactorization * kSecondsPerEdge * kFlopsPerSecond *
                            static_cast<double>(structure.num_edges());
  const bool is_full =
      static_cast<double>(layout.blocks.size()) > kDenseFraction * 0.5 * n * (n + 1.0);
  const double dense_flops = scalars * scalars * scalars / 3.0;
  if (is_full && (!structure.IsLarge() || dense_flops <= 2.0 * affordable)) {
    *reason = "most blocks of S are there";
    return LinearSolverType::kDenseCholesky;
  }
  if (!is_full) {
    w->sparse_cholesky.Analyze(layout);
    if (!structure.IsLarge() || w->sparse_cholesky.Flops() <= affordable) {
      if (w->sparse_cholesky.FlopRatio() < kWorthwhile) {
        *reason = "a sparse factor has least to do";
        return LinearSolverType::kSparseCholesky;
      }
      *reason = "a sparse factor would be nearly full";
      return LinearSolverType::kDenseCholesky;
    }
  }
  *reason = "factorizing would take longer than all else";
  std::int64_t blocks = 0;
  for (const BlockIndex& block : layout.blocks)
    blocks += layout.Dim(block.row) * layout.Dim(block.col);
  return blocks <= structure.landmark_buffer_size() ? LinearSolverType::kPcg
                                                    : LinearSolverType::kImplicitPcg;
}

const char* NameOf(LinearSolverType type) {
  switch (type) {
    case LinearSolverType::kDenseCholesky:
      return "dense";
    case LinearSolverType::kSparseCholesky:
      return "sparse";
    case LinearSolverType::kPcg:
      return "pcg";
    case LinearSolverType::kImplicitPcg:
      return "implicit-pcg";
    case LinearSolverType::kAuto:
      break;
  }
  return "auto";
}

Status Refuse(std::initializer_list<std::string_view> parts) {
  std::string message;
  for (const std::string_view part : parts)
    message.append(part);
  return {StatusCode::kOutOfMemory, message};
}

Status TooMuch(const MemoryEstimate& m, LinearSolverType type, std::int64_t limit) {
  return Refuse({"the solve needs ", Megabytes(m.total()), " MB (graph ", Megabytes(m.graph),
                 ", structure ", Megabytes(m.structure), ", H ", Megabytes(m.equations), ", S ",
                 Megabytes(m.reduced), ", ", NameOf(type), " ", Megabytes(m.solver),
                 "), memory_limit is ", Megabytes(limit), " MB"});
}

}  // namespace

Status ChooseSolver(const Graph& graph, SolverWorkspace* w, const SolveOptions& options,
                    SolverChoice* choice) {
  ReducedSolver& about = choice->description;
  about = {};
  const Structure& structure = w->structure;
  about.scalars = structure.num_pose_scalars();
  const SchurLayout& layout = w->equations.ReducedLayout(structure);
  const auto n = static_cast<double>(layout.num_vertices());
  if (n > 0.0) about.density = static_cast<double>(layout.blocks.size()) / (0.5 * n * (n + 1.0));
  const bool chooses = ChoosesSolver(options);
  if (chooses) {
    choice->type = Preferred(w, &about.reason);
  } else {
    choice->type = options.linear_solver_type;
    about.reason = "asked for";
    if (choice->type == LinearSolverType::kSparseCholesky) w->sparse_cholesky.Analyze(layout);
  }
  if (options.memory_limit > 0 || structure.IsLarge()) {
    const auto estimate = [&](LinearSolverType type) {
      choice->memory = EstimateMemory(graph, structure, &w->equations, w->sparse_cholesky, type,
                                      options.num_threads);
      choice->type = type;
      about.memory_bytes = choice->memory.total();
      return options.memory_limit <= 0 || about.memory_bytes <= options.memory_limit;
    };
    bool fits = estimate(choice->type);
    if (!fits && chooses) {
      about.reason = "others would exceed memory_limit";
      for (const LinearSolverType type : {LinearSolverType::kPcg, LinearSolverType::kImplicitPcg}) {
        fits = fits || estimate(type);
      }
    }
    if (!fits) {
      return TooMuch(choice->memory, choice->type, options.memory_limit);
    }
  }
  about.name = options.linear_solver != nullptr ? "user's" : NameOf(choice->type);
  if (w->sparse_cholesky.IsOf(layout)) about.factor_flops = w->sparse_cholesky.Flops();
  // What was looked at and not taken need not stay.
  if (structure.IsLarge() && choice->type != LinearSolverType::kSparseCholesky)
    w->sparse_cholesky = SparseCholeskySolver();
  return {};
}

Status AnalyzeForSolve(Graph* graph, SolverWorkspace* w, const SolveOptions& options) {
  const std::int64_t limit = options.memory_limit;
  if (limit > 0 && Structure::AnalysisBytes(*graph) > limit) {
    return Refuse({"the analysis alone needs ", Megabytes(Structure::AnalysisBytes(*graph)),
                   " MB, memory_limit is ", Megabytes(limit), " MB"});
  }
  Status status = w->structure.Analyze(
      graph, {.allow_duplicate_observations = options.allow_duplicate_observations,
              .needs_records = !w->equations.IsPlanned(w->structure)});
  if (!status.ok()) return status;
  w->equations.Plan(w->structure, *graph);
  if (w->structure.IsLarge()) w->structure.ReleaseScratch(w->equations.PoolsInRuns(w->structure));
  return ChooseSolver(*graph, w, options, &w->choice);
}

}  // namespace glissade
