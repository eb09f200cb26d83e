// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/pools.h"
#include "glissade/marginal/marginalize.h"

namespace glissade::internal {

/// A vertex in the quadratic that is marginalized.
struct MarginalVariable {
  enum class Kind : std::uint8_t {
    kLandmark,  ///< goes, by its own block
    kGoes,      ///< goes, with the dense part
    kStays,
    kHeld,  ///< goes, but is fixed: no columns
  };
  Kind kind = Kind::kStays;
  VertexPoolBase* pool = nullptr;
  std::int32_t index = 0;
  std::int32_t dim = 0;       ///< columns: tangent or free tangent dimension
  std::int32_t column = 0;    ///< first column of the dense part; landmarks: their number
  std::int32_t tangent = -1;  ///< of Graph::free_tangents(), where partly fixed
  const double* x = nullptr;
  const double* x0 = nullptr;  ///< x where the vertex is linearized at its present value
  bool moved = false;          ///< x != x0
  std::int32_t delta = 0;      ///< offset of x boxminus x0 among deltas()
};

/// A folded edge: its vertices are variables()[of_edge()[begin + i]].
struct MarginalEdge {
  const EdgePoolBase* pool = nullptr;
  std::int32_t edge = 0;
  std::int32_t begin = 0;
  std::int32_t arity = 0;
  std::int32_t rows = 0;
  std::int32_t landmark = -1;  ///< number of its landmark
};

/// Rows [J | r0] over a few variables, row-major. Columns of the variables in their order, the
/// landmark (if there is one) first, r0 last; what is beyond in a row is zero.
struct RowPanel {
  struct Part {
    std::int32_t variable;
    std::int32_t column;  ///< in the panel
  };
  std::vector<Part> parts;
  std::vector<double> data;
  int rows = 0;
  int columns = 0;  ///< with r0
  int stride = 0;
  int landmark_dim = 0;

  double* Row(int row) { return data.data() + static_cast<std::size_t>(row * stride); }
};

/// What is marginalized, from a graph: which edges are folded in, which variables they have, in
/// what order, and the rows that they contribute.
class MarginalSystem {
 public:
  Status Build(const Graph& graph, std::span<const AnyVertex> vertices,
               const MarginalizeOptions& options, MarginalReport* report);

  [[nodiscard]] const std::vector<MarginalVariable>& variables() const { return variables_; }
  [[nodiscard]] const MarginalVariable& variable(int i) const {
    return variables_[static_cast<std::size_t>(i)];
  }
  /// Variables of the dense part in the order of their columns: those that go, then those that
  /// stay.
  [[nodiscard]] const std::vector<std::int32_t>& dense_order() const { return dense_order_; }
  [[nodiscard]] int going_dim() const { return going_dim_; }
  [[nodiscard]] int staying_dim() const { return staying_dim_; }
  [[nodiscard]] int num_landmarks() const { return static_cast<int>(landmarks_.size()); }
  /// Edges by landmark, then those without one.
  [[nodiscard]] std::span<const MarginalEdge> EdgesOf(int landmark) const;
  [[nodiscard]] std::span<const MarginalEdge> OtherEdges() const {
    return EdgesOf(num_landmarks());
  }
  [[nodiscard]] int landmark_variable(int landmark) const {
    return landmarks_[static_cast<std::size_t>(landmark)];
  }
  /// The edge as a marginal prior, null if it is something else.
  [[nodiscard]] static const EdgeMarginalPrior* AsPrior(const MarginalEdge& edge);
  /// All vertices of a prior are where it was linearized, as far as the new one is concerned: its
  /// J and r0 can be taken as they are.
  [[nodiscard]] bool IsUnmoved(const MarginalEdge& edge) const;
  [[nodiscard]] const MarginalVariable& VertexOf(const MarginalEdge& edge, int i) const {
    return variable(of_edge_[static_cast<std::size_t>(edge.begin + i)]);
  }

  /// Fills the rows of edges that share their landmark, or of one edge. Names an edge that has no
  /// finite value.
  Status Linearize(std::span<const MarginalEdge> edges, RowPanel* panel);

 private:
  Status MarkGoing(const Graph& graph, std::span<const AnyVertex> vertices);
  Status CollectEdges(const Graph& graph, const MarginalizeOptions& options,
                      MarginalReport* report);
  void Classify(const Graph& graph);
  void OrderVariables();
  void SortEdges();
  void SetPoints();
  std::int32_t FindOrAdd(VertexPoolBase* pool, std::int32_t index);
  void LayOutPanel(std::span<const MarginalEdge> edges, RowPanel* panel);
  bool LinearizeEdge(const MarginalEdge& edge, double* rows, const RowPanel& panel);
  void LinearizePrior(const MarginalEdge& edge, double* rows, const RowPanel& panel);
  void AddBlock(const MarginalVariable& variable, const double* J, int rows, int stride_of_J,
                const RowPanel& panel, double* out);
  void SubtractDelta(const MarginalVariable& variable, int rows, const double* J,
                     const RowPanel& panel, double* out) const;
  /// J (rows x dim) with respect to the tangent at x becomes that with respect to x0's.
  void MoveToOrigin(const MarginalVariable& variable, int rows, double* J);

  const Graph* graph_ = nullptr;
  FirstEstimates mode_ = FirstEstimates::kFull;
  std::vector<MarginalVariable> variables_;
  std::vector<std::vector<std::int32_t>> variable_of_;  // pool, index -> variable or -1
  std::vector<std::int32_t> landmarks_;                 // variables
  std::vector<std::int32_t> dense_order_;
  int going_dim_ = 0, staying_dim_ = 0;
  std::vector<MarginalEdge> edges_, unsorted_;
  std::vector<std::int32_t> of_edge_;
  std::vector<std::int32_t> edges_begin_;
  // Scratch.
  std::vector<std::int32_t> indices_, rank_, panel_column_, fill_;
  std::vector<double> deltas_, residual_, jacobian_, product_, origin_;
  std::vector<const double*> states_, points_;
  std::vector<double*> blocks_;
};

}  // namespace glissade::internal
