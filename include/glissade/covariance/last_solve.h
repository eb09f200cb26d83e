// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "glissade/covariance/covariance.h"
#include "glissade/minimizer/minimizer.h"

namespace glissade {

/// The joint covariance of vertices that are not eliminated, from what the last step of the
/// workspace's last solve was computed from: S at the last linearization but the one after that
/// step, in that solve's gauge, its damping taken out. Costs one factorization of S and a forward
/// substitution; for an estimator that needs the covariance of what it has just solved for, after
/// variables were marginalized too: vertices are those that the solve knew, also where they have
/// left the graph since.
///
/// What damping did to eliminated landmarks stays in S, which nobody sees up to lambda = 1e-6 of
/// their own diagonals; where the last step was damped by more, by the identity, or by a solver
/// that does not store S, and before a solve that made a step: kInvalidArgument. Solve then with a
/// smaller SolveOptions::initial_lambda, or ask Covariance. kUnknownHandle for a vertex that is not
/// in the reduced system; kSingular where directions are without information.
///
/// The graph is the workspace's; only what its group of gauge motions is, is asked of it.
[[nodiscard]] Result<JointCovariance> CovarianceOfLastSolve(const Graph& graph,
                                                            SolverWorkspace* workspace,
                                                            std::span<const AnyVertex> vertices);

}  // namespace glissade
