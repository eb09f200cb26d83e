// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "glissade/graph/pools.h"
#include "glissade/linear/normal_equations.h"

/// \file
/// Landmarks eliminated in groups, poses as twists, against the same one by one.
namespace glissade::test {

/// Everything one way makes of a graph at one lambda.
struct PathOutcome {
  Structure structure;
  NormalEquations equations;
  ThreadPool threads;
  DenseCholeskySolver solver;
  double cost = 0.0;
  Graph* graph;

  PathOutcome(Graph* g, bool group, const DampingTerm& damping) : graph(g) {
    EXPECT_TRUE(
        structure.Analyze(g, {.allow_duplicate_observations = true, .group_landmarks = group})
            .ok());
    Run(damping);
  }
  void Run(const DampingTerm& damping) {
    Status status = equations.Linearize(structure, graph, &threads, &cost);
    EXPECT_TRUE(status.ok()) << status.message();
    status = equations.Eliminate(structure, *graph, damping, SchurForm::kDense, &threads);
    EXPECT_TRUE(status.ok()) << status.message();
    LinearSolverResult result;
    status = equations.Solve(structure, *graph, &solver, {}, &threads, &result);
    EXPECT_TRUE(status.ok()) << status.message();
  }
  /// values: in the order of step().
  [[nodiscard]] double Of(const std::vector<double>& values, int pool, int index, int k) const {
    const std::int32_t offset = structure.step_offsets(pool)[static_cast<std::size_t>(index)];
    return offset < 0 ? 0.0 : values[static_cast<std::size_t>(offset + k)];
  }
  /// H_pp as a dense matrix, row by row.
  [[nodiscard]] std::vector<double> PoseHessian() {
    const auto n = static_cast<std::size_t>(structure.num_pose_scalars());
    std::vector<double> dense(n * n, 0.0);
    const Hessian H = equations.GetHessian(structure);
    for (std::size_t k = 0; k < H.num_pairs(); ++k) {
      const Hessian::PosePair pair = H.Pair(k);
      for (int r = 0; r < pair.H.rows; ++r) {
        for (int c = 0; c < pair.H.cols; ++c) {
          const auto row = static_cast<std::size_t>(H.offset(pair.row) + r);
          const auto col = static_cast<std::size_t>(H.offset(pair.col) + c);
          dense[row * n + col] = dense[col * n + row] = pair.H(r, c);
        }
      }
    }
    return dense;
  }
};

/// Cost, H, b, S, b_s and the step; H and S in units of their own diagonals, the step to
/// 1e3 * tolerance of its largest number.
inline void ExpectSame(PathOutcome* groups, PathOutcome& single, double tolerance) {
  const Graph& graph = *single.graph;
  EXPECT_NEAR(groups->cost, single.cost, 1e-12 * single.cost);
  EXPECT_NEAR(groups->equations.MaxGradient(), single.equations.MaxGradient(),
              tolerance * single.equations.MaxGradient());
  EXPECT_NEAR(groups->equations.MaxDiagonal(), single.equations.MaxDiagonal(),
              tolerance * single.equations.MaxDiagonal());

  const auto n = static_cast<std::size_t>(single.structure.num_pose_scalars());
  const std::vector<double> H_a = groups->PoseHessian(), H_b = single.PoseHessian();
  ASSERT_EQ(H_a.size(), H_b.size());
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      ASSERT_NEAR(H_a[i * n + j], H_b[i * n + j],
                  tolerance * std::sqrt(H_b[i * n + i] * H_b[j * n + j]))
          << "H " << i << ' ' << j;
    }
  }
  ASSERT_EQ(groups->equations.reduced().layout().size(), static_cast<std::int64_t>(n));
  ASSERT_EQ(single.equations.reduced().layout().size(), static_cast<std::int64_t>(n));
  const BlockView S_a = groups->equations.reduced().Block(0);
  const BlockView S_b = single.equations.reduced().Block(0);
  const auto at = [](const BlockView& S, std::size_t i, std::size_t j) {
    return S.data[i + j * static_cast<std::size_t>(S.stride)];
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      ASSERT_NEAR(at(S_a, i, j), at(S_b, i, j),
                  tolerance * std::sqrt(at(S_b, i, i) * at(S_b, j, j)))
          << "S " << i << ' ' << j;
    }
  }
  const std::vector<double>& b_a = groups->equations.reduced_rhs();
  const std::vector<double>& b_b = single.equations.reduced_rhs();
  double b_max = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    b_max = std::max(b_max, std::abs(b_b[i]));
  for (std::size_t i = 0; i < n; ++i)
    ASSERT_NEAR(b_a[i], b_b[i], tolerance * b_max) << "b_s " << i;
  double step_max = 0.0;
  for (const double x : single.equations.step())
    step_max = std::max(step_max, std::abs(x));
  for (const auto& pool : graph.vertex_pools()) {
    const int id = pool->id();
    for (int k = 0; k < pool->size(); ++k) {
      for (int i = 0; i < pool->ops().tangent_dim; ++i) {
        const double h = single.Of(single.equations.diagonal(), id, k, i);
        ASSERT_NEAR(groups->Of(groups->equations.diagonal(), id, k, i), h, tolerance * h)
            << "H " << pool->ops().type->name << ' ' << k;
        // A gradient is a sum of products of columns of the Jacobian with residuals.
        ASSERT_NEAR(groups->Of(groups->equations.b(), id, k, i),
                    single.Of(single.equations.b(), id, k, i),
                    tolerance * std::sqrt(2.0 * h * single.cost))
            << "b " << pool->ops().type->name << ' ' << k;
        ASSERT_NEAR(groups->Of(groups->equations.step(), id, k, i),
                    single.Of(single.equations.step(), id, k, i), 1e3 * tolerance * step_max)
            << "step " << pool->ops().type->name << ' ' << k;
      }
    }
  }
  double cost_again = 0.0;
  EXPECT_TRUE(groups->equations.Cost(groups->structure, graph, &groups->threads, &cost_again).ok());
  EXPECT_NEAR(cost_again, single.cost, 1e-12 * single.cost);
  EXPECT_NEAR(cost_again, graph.Cost().value(), 1e-12 * single.cost);
}

}  // namespace glissade::test
