// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <span>
#include <vector>

#include "glissade/graph/graph.h"

/// \file
/// A graph as a ceres::Problem and back: to compare, and to move over step by step in either
/// direction. Needs Ceres >= 2.1; link glissade::ceres_bridge.
///
///     auto exported = bridge::Export(graph);
///     ceres::Solver::Options options;
///     options.linear_solver_ordering = exported.MakeOrdering();
///     ceres::Solver::Summary summary;
///     ceres::Solve(options, &exported.problem(), &summary);
///     bridge::ReadBack(exported, &graph);
namespace glissade::bridge {

/// A graph exported to Ceres. Owns a copy of everything, edges and states: the graph it came from
/// may change or go. Ceres works on the copy's states.
///
/// One residual block per edge, whitened, with the edge's loss. One parameter block per vertex:
/// - the ambient state with the vertex type's manifold (none for additive types);
/// - Fix::kWhole: the same, constant;
/// - Fix::kPosition, Fix::kBiases: the vertex with a manifold of three dimensions;
/// - Fix::kNumbers: the vertex with a manifold of those that are free;
/// - Fix::kPositionAndYaw: two numbers, dphi_x and dphi_y of the chart in graph/fix.h, additive.
/// So Ceres's tangent is glissade's free tangent, number by number.
class CeresProblem {
 public:
  CeresProblem(CeresProblem&&) noexcept;
  CeresProblem& operator=(CeresProblem&&) noexcept;
  ~CeresProblem();

  /// Not ok where the graph could not be copied (Graph::Clone); the problem is then empty.
  [[nodiscard]] const Status& status() const;
  [[nodiscard]] ceres::Problem& problem();
  [[nodiscard]] const ceres::Problem& problem() const;

  /// All vertices, in the graph's order.
  [[nodiscard]] std::span<const AnyVertex> vertices() const;
  /// The vertex's parameter block; null for a vertex that was not in the graph.
  [[nodiscard]] double* ParameterBlock(AnyVertex vertex) const;
  /// The edge's residual block; null for an edge that was not in the graph.
  [[nodiscard]] ceres::ResidualBlockId ResidualBlock(AnyEdge edge) const;
  /// Degrees of freedom of a vertex in Ceres's problem: 0 where it is fixed or unknown.
  [[nodiscard]] int FreeDim(AnyVertex vertex) const;
  /// The ambient state that the parameter block stands for at present; empty if unknown.
  [[nodiscard]] std::vector<double> State(AnyVertex vertex) const;

  /// Eliminated vertices in group 0, all others in group 1: what *_SCHUR solvers are to eliminate.
  /// Null if nothing is eliminated; Ceres then orders by itself.
  [[nodiscard]] std::shared_ptr<ceres::ParameterBlockOrdering> MakeOrdering() const;

 private:
  friend CeresProblem Export(const Graph& graph);
  friend Status ReadBack(const CeresProblem& exported, Graph* graph);
  struct Impl;
  explicit CeresProblem(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Copies the graph into a ceres::Problem.
CeresProblem Export(const Graph& graph);

/// Writes Ceres's present states (and gauge charts) into the graph that was exported, or a clone of
/// it. Vertices added since stay as they are. Refused, with the graph unchanged: an exported vertex
/// that was removed (kUnknownHandle), a state that is not finite (kNotFinite).
Status ReadBack(const CeresProblem& exported, Graph* graph);

/// Export, ceres::Solve, ReadBack. Where options.linear_solver_ordering is null it is set to
/// MakeOrdering(). The graph is left as it was unless the solution is usable.
ceres::Solver::Summary SolveWithCeres(Graph* graph, ceres::Solver::Options options = {});

/// What Ceres makes of the graph at the present parameter values, in glissade's free tangent.
struct CeresLinearization {
  double cost = 0.0;  ///< 1/2 sum rho(s)
  /// With the robust losses' correction (graph/robust.h) applied; rows by edge in the order of
  /// Graph::Edges(), columns by vertex in the order asked for.
  Eigen::VectorXd residuals;
  Eigen::SparseMatrix<double, Eigen::RowMajor> jacobian;
  Eigen::VectorXd gradient;  ///< J'r
  /// First column of each vertex asked for, and the number of columns at the end.
  std::vector<int> offsets;

  /// J'J, dense: for problems of a few thousand unknowns at most.
  [[nodiscard]] Eigen::MatrixXd Hessian() const {
    return Eigen::MatrixXd(jacobian.transpose() * jacobian);
  }
};

/// Evaluates the exported problem through ceres::Problem::Evaluate. `order`: the vertices whose
/// tangents are the columns, for instance Problem::FreeVertices(); refused if one is unknown
/// (kUnknownHandle) or fixed (kInvalidArgument). kEvaluationFailed if an edge has no value.
Result<CeresLinearization> Linearize(const CeresProblem& exported,
                                     std::span<const AnyVertex> order);

}  // namespace glissade::bridge
