// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/pools.h"
#include "glissade/minimizer/minimizer.h"

#include <algorithm>
#include <cmath>
#include <new>

namespace glissade {

LinearSolver* SolverWorkspace::Solver(const SolveOptions& options, LinearSolverType type) {
  if (options.linear_solver != nullptr) return options.linear_solver;
  switch (type) {
    case LinearSolverType::kSparseCholesky:
      return &sparse_cholesky;
    case LinearSolverType::kPcg:
      pcg.set_preconditioner(options.pcg.preconditioner);
      return &pcg;
    case LinearSolverType::kImplicitPcg:
      implicit_pcg.set_preconditioner(options.pcg.preconditioner);
      return &implicit_pcg;
    case LinearSolverType::kDenseCholesky:
    case LinearSolverType::kAuto:
      break;
  }
  return &dense_cholesky;
}

SolverWorkspace::Wish SolverWorkspace::AskWhatToStore(LinearSolver* solver) {
  Wish wish;
  wish.form = solver->Form(equations.ReducedLayout(structure));
  if (wish.form == SchurForm::kSomeBlocks) wish.blocks = solver->WantedBlocks();
  return wish;
}

void SolvedSystem::Begin(const Structure& structure, const Graph& graph, const Gauge& in_force) {
  is_there = false;
  gauge = in_force;
  references = graph.gauge_references();
  tangents = graph.free_tangents();
  vertices.clear();
  state_offsets.assign(1, 0);
  for (const PoseBlock& pose : structure.poses()) {
    const VertexPoolBase& pool = *graph.vertex_pools()[static_cast<std::size_t>(pose.pool)];
    vertices.push_back(pool.HandleAt(pose.index));
    state_offsets.push_back(state_offsets.back() +
                            static_cast<std::size_t>(pool.ops().ambient_dim));
  }
  states.resize(state_offsets.back());
}

void SolvedSystem::Keep(const Structure& structure, const Graph& graph) {
  is_there = true;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const PoseBlock& pose = structure.poses()[k];
    const double* from =
        graph.vertex_pools()[static_cast<std::size_t>(pose.pool)]->Data(pose.index);
    std::copy_n(from, state_offsets[k + 1] - state_offsets[k], states.data() + state_offsets[k]);
  }
  // Their bases are those of the linearization.
  std::copy(graph.free_tangents().begin(), graph.free_tangents().end(), tangents.begin());
}

void SolverWorkspace::Discard() noexcept {
  discarded = true;
  solved.is_there = false;
  try {
    Restore();
  } catch (const std::bad_alloc&) {
    // The next use tries again.
  }
}

void SolverWorkspace::Restore() {
  if (!discarded) return;
  structure = Structure();
  equations = NormalEquations();
  dense_cholesky = DenseCholeskySolver();
  sparse_cholesky = SparseCholeskySolver();
  pcg = PcgSolver();
  implicit_pcg = PcgSolver(PcgSolver::Schur::kImplicit);
  for (auto* v : {&dogleg_scale, &dogleg_gradient, &dogleg_step, &watched_states})
    *v = {};
  discarded = false;
}

void ApplyStep(const Structure& structure, const std::vector<double>& step, Graph* graph) {
  for (const auto& pool : graph->vertex_pools()) {
    pool->Plus(step.data(), structure.step_offsets(pool->id()).data(), pool->size());
  }
  for (const PoseBlock& pose : structure.poses()) {
    if (pose.free_tangent < 0) continue;
    VertexPoolBase& pool = *graph->vertex_pools()[static_cast<std::size_t>(pose.pool)];
    graph->free_tangents()[static_cast<std::size_t>(pose.free_tangent)].Plus(
        step.data() + pose.offset, pool.Data(pose.index));
  }
}

DampingTerm MakeDamping(const SolveOptions& options, double lambda) {
  DampingTerm damping;
  damping.lambda = lambda;
  damping.identity = options.damping == Damping::kIdentity;
  damping.reduced_only = options.damping == Damping::kPoseBlock;
  damping.min_diagonal = options.min_diagonal;
  damping.max_diagonal = options.max_diagonal;
  return damping;
}

SolveRequest MakeRequest(const SolveOptions& options, double forcing, double progress) {
  SolveRequest request;
  request.tolerance = options.pcg.tolerance;
  request.max_iterations = options.pcg.max_iterations;
  request.model_tolerance = std::clamp(std::sqrt(progress), 0.3 * forcing, forcing);
  return request;
}

}  // namespace glissade
