// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/edges/dynamic.h"
#include "glissade/graph/graph.h"

namespace glissade {

/// How the prior is computed. Both give the same quadratic, up to rounding: the square-root form
/// loses cond(J) = sqrt(cond(H)), the Schur complement cond(H), and can become indefinite.
enum class MarginalForm {
  /// Householder QR of the stacked rows [J | r0], landmark by landmark, then columns that go, then
  /// columns that stay; J is upper triangular. (Demmel et al., "Square Root Marginalization for
  /// Sliding-Window Bundle Adjustment", ICCV 2021.)
  kSquareRootQr,
  /// H by blocks, Schur complements, and a square root of what is left.
  kSchur,
};

/// Square root of the information that the Schur complement leaves.
enum class InformationRoot {
  kCholesky,  ///< pivoted where it is rank deficient
  kEigen,     ///< eigenvalues of the Jacobi-scaled matrix, with a relative cut
};

struct MarginalizeOptions {
  MarginalForm form = MarginalForm::kSquareRootQr;
  InformationRoot root = InformationRoot::kCholesky;  ///< for kSchur
  /// Directions of what goes with less information than this part of the most, in units that give
  /// H a unit diagonal, count as having none; likewise in the root of the Schur form. <= 0: the
  /// rounding of the sizes at hand. Below 1. The square-root form applies the square root of it to
  /// J, and to what goes only: columns that stay are cut at rounding.
  double relative_cut = 0.0;
  /// Edges not to be folded into the prior but dropped (lost), as OKVIS does with observations to
  /// keep the prior sparse. Edges that no marginalized vertex touches are not affected.
  std::span<const AnyEdge> drop = {};
  /// The same as a rule.
  std::function<bool(const Graph&, AnyEdge)> drop_if = {};
};

/// What happened, apart from the prior itself.
struct MarginalReport {
  int folded_edges = 0;   ///< older priors included
  int folded_priors = 0;  ///< older priors among them
  int dropped_edges = 0;
  int eliminated_landmarks = 0;  ///< block by block
  int marginalized_dim = 0;      ///< tangent dimensions that went, landmarks included
  /// Directions among them that nothing informs about; they take nothing with them.
  int rank_deficiency = 0;
  /// The vertices these directions belong to.
  std::vector<AnyVertex> deficient;
  /// 1/2 r'r at the best values of what went: the part of the cost that does not depend on what is
  /// left, and which the prior leaves out.
  double constant_cost = 0.0;
};

/// r(x) = r0 + J (x boxminus x0), as numbers.
struct MarginalPrior {
  /// What is left and touched; columns of J in this order. Empty if nothing was connected.
  std::vector<AnyVertex> vertices;
  std::vector<double> x0;        ///< ambient states, one after the other
  std::vector<double> r0;        ///< rows
  std::vector<double> jacobian;  ///< rows x tangent_dim, row-major
  int tangent_dim = 0;
  MarginalReport report;

  [[nodiscard]] int rows() const { return static_cast<int>(r0.size()); }
};

/// Storage that is kept from one marginalization to the next: with it, none but the first of its
/// size allocates. Not for use by two threads at once.
class MarginalWorkspace {
 public:
  MarginalWorkspace();
  ~MarginalWorkspace();
  MarginalWorkspace(MarginalWorkspace&&) noexcept;
  MarginalWorkspace& operator=(MarginalWorkspace&&) noexcept;

  class Impl;
  [[nodiscard]] Impl& impl();

 private:
  std::unique_ptr<Impl> impl_;
};

/// The prior that is left of the given vertices and of all edges that touch them, at the graph's
/// present values; the graph is not changed. Linearization points follow graph.first_estimates():
///
///  - kOff: everything at x; an older prior is moved there (r0 += J (x boxminus x0), J <- J Jr^-1).
///  - kPriorOnly, kFull: factors are linearized at x_lin where vertices have one and enter as
///    r(x) - J (x boxminus x_lin), so that the prior's value at x is exact; x0 of the prior is
///    x_lin (x for vertices that a prior touches for the first time).
///
/// Robust losses enter with their weight at x. Marginalized vertices that are fixed are conditioned
/// on; partly fixed ones are marginalized over their free tangent. Neighbours that are fixed become
/// variables of the prior nevertheless: what holds them now may let go later.
///
/// Refused, with the culprit: options that make no sense, dead handles, a vertex given twice, an
/// edge without a finite value. kOutOfMemory where memory runs out.
Result<MarginalPrior> ComputeMarginalPrior(const Graph& graph, std::span<const AnyVertex> vertices,
                                           const MarginalizeOptions& options = {},
                                           MarginalWorkspace* workspace = nullptr);
/// The same into *prior, the storage of which serves again.
Status ComputeMarginalPrior(const Graph& graph, std::span<const AnyVertex> vertices,
                            const MarginalizeOptions& options, MarginalWorkspace* workspace,
                            MarginalPrior* prior);

/// The prior in the graph; converts to its handle.
struct Marginalization {
  /// Null if nothing was connected to what went.
  EdgeHandle<DynamicEdge> prior;
  int rows = 0;
  int tangent_dim = 0;
  MarginalReport report;

  operator EdgeHandle<DynamicEdge>() const { return prior; }  // NOLINT: implicit, it is one
  operator AnyEdge() const { return prior; }                  // NOLINT
};

/// Takes the vertices and all edges that touch them out of the graph and puts the prior of
/// ComputeMarginalPrior in their place. Landmarks that come under a prior with another landmark in
/// it are no longer eliminated by solves (SetEliminated(v, false)). All or nothing: on failure the
/// graph is as it was.
Result<Marginalization> Marginalize(Graph* graph, std::span<const AnyVertex> vertices,
                                    const MarginalizeOptions& options = {},
                                    MarginalWorkspace* workspace = nullptr);

}  // namespace glissade
