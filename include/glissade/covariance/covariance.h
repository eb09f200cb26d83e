// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <memory>
#include <span>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/gauge/gauge.h"
#include "glissade/gauge/orbit.h"
#include "glissade/graph/graph.h"

namespace glissade {

struct CovarianceOptions {
  /// Free: as the graph's own fixing and priors have it. For the covariance of a scene that nothing
  /// ties down name a gauge; its anchor's gauge coordinates are then certain.
  Gauge gauge = {};
  int num_threads = 1;  ///< does not change a bit of the result
  /// A direction counts as without information where a pivot of the system scaled by diag(H) falls
  /// below this.
  double min_pivot = 1e-11;
};

/// The joint covariance of a few vertices: symmetric, in their full tangents, one after the other.
/// Coordinates that are held are certain: their rows are zero.
struct JointCovariance {
  std::vector<AnyVertex> vertices;
  std::vector<int> offsets;    ///< first row of each vertex, and the number of rows at the end
  std::vector<double> values;  ///< size() x size()
  /// The gauge it is in, the states it was linearized at (ambient, one after the other), and how
  /// the scene moves: what TransformCovariance() needs.
  Gauge gauge;
  std::vector<double> states;
  std::vector<std::size_t> state_offsets;  ///< first number of each vertex
  Orbit orbit;
  std::vector<GaugeReference> references;  ///< the graph's: what yaw means at which anchor

  [[nodiscard]] int size() const { return offsets.empty() ? 0 : offsets.back(); }
  /// Index in vertices, -1 if not there.
  [[nodiscard]] int IndexOf(AnyVertex vertex) const;
  template <int = 0>
  [[nodiscard]] Eigen::MatrixXd Matrix() const {
    return Eigen::Map<const Eigen::MatrixXd>(values.data(), size(), size());
  }
  /// Cov(a, b), tangent dimension of a x that of b. Empty for vertices that are not there.
  template <int = 0>
  [[nodiscard]] Eigen::MatrixXd Block(AnyVertex a, AnyVertex b) const {
    const int i = IndexOf(a), j = IndexOf(b);
    if (i < 0 || j < 0) return {};
    const auto at = [&](int k) { return offsets[static_cast<std::size_t>(k)]; };
    return Eigen::Map<const Eigen::MatrixXd>(values.data(), size(), size())
        .block(at(i), at(j), at(i + 1) - at(i), at(j + 1) - at(j));
  }
  template <int = 0>
  [[nodiscard]] Eigen::MatrixXd Block(AnyVertex vertex) const {
    return Block(vertex, vertex);
  }
};

/// Marginal covariances, H^-1 of the linearization at the present values, through the elimination:
/// the reduced system S is scaled by the diagonal of H (Jacobi) and factored once by Cholesky; a
/// block then costs one forward substitution per column, landmarks by back-substitution through W:
///     Cov(a, b) = A_a' S^-1 A_b + [a = b, a landmark] H_ll^-1,   A = -W H_ll^-1 for a landmark.
/// No dense inverse, no eigenvalues.
class Covariance {
 public:
  Covariance();
  ~Covariance();
  Covariance(Covariance&&) noexcept;
  Covariance& operator=(Covariance&&) noexcept;

  /// Linearizes and factors. kSingular where the graph (in the gauge) leaves directions open: names
  /// the vertices without information, which Uninformed() then lists; kOutOfMemory where memory
  /// runs out. The graph is left as it was (compacted).
  Status Compute(Graph* graph, const CovarianceOptions& options = {});
  /// Vertices in which Compute() found directions without information given all vertices before
  /// them: an order, not a judgement, where several share what is missing.
  [[nodiscard]] const std::vector<AnyVertex>& Uninformed() const;

  /// Of the graph at the last Compute(), with later changes unseen. kUnknownHandle for a vertex
  /// that was not there, kSingular for one without any edge, kInvalidArgument before a Compute()
  /// that succeeded.
  [[nodiscard]] Result<JointCovariance> Joint(std::span<const AnyVertex> vertices) const;
  [[nodiscard]] Result<JointCovariance> Joint(std::initializer_list<AnyVertex> vertices) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Compute() and Joint() in one call.
Result<JointCovariance> ComputeCovariance(Graph* graph, std::span<const AnyVertex> vertices,
                                          const CovarianceOptions& options = {});

/// For study only: the Moore-Penrose pseudo-inverse of the whole H, nothing fixed beyond the
/// graph's own fixing, by a dense eigendecomposition (all vertices, cubic in their number). Its
/// values depend on the units of the tangent: degrees instead of radians give another matrix, not
/// the same in other units. null_dimension eigenvalues, the smallest, count as zero; negative: as
/// many as the graph's gauge group has directions.
Result<JointCovariance> RawFreeGaugePseudoInverse(Graph* graph, int null_dimension = -1);

}  // namespace glissade
