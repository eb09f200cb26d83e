// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/minimizer/memory.h"

#include "glissade/graph/pools.h"
#include "glissade/linear/normal_equations.h"
#include "glissade/linear/sparse_cholesky.h"
#include "glissade/structure/structure.h"

namespace glissade {

namespace {

SchurForm FormOf(LinearSolverType type) {
  switch (type) {
    case LinearSolverType::kDenseCholesky:
      return SchurForm::kDense;
    case LinearSolverType::kImplicitPcg:
      return SchurForm::kDiagonalBlocks;
    default:
      return SchurForm::kBlocks;
  }
}

}  // namespace

MemoryEstimate EstimateMemory(const Graph& graph, const Structure& structure,
                              NormalEquations* equations, const SparseCholeskySolver& sparse,
                              LinearSolverType type, int num_threads) {
  constexpr std::int64_t kDouble = sizeof(double);
  MemoryEstimate memory;
  memory.linear_solver = type;
  for (const auto& pool : graph.vertex_pools())
    memory.graph += pool->MemoryBytes();
  for (const auto& pool : graph.edge_pools())
    memory.graph += pool->MemoryBytes();
  memory.structure = structure.MemoryBytes();
  memory.equations = equations->MemoryBytes(structure);
  memory.reduced = equations->ReducedMemoryBytes(structure, FormOf(type), num_threads);
  const std::int64_t n = structure.num_pose_scalars();
  switch (type) {
    case LinearSolverType::kDenseCholesky:
      memory.solver = kDouble * n * (n + 8);
      break;
    case LinearSolverType::kSparseCholesky:
      memory.solver = sparse.MemoryBytes();
      break;
    case LinearSolverType::kPcg:
    case LinearSolverType::kImplicitPcg:
    case LinearSolverType::kAuto:
      // Vectors, those of the parts of a product, and the preconditioner.
      memory.solver = kDouble * (32 * n + 16 * n);
      break;
  }
  return memory;
}

}  // namespace glissade
