// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "glissade/edges/dynamic.h"
#include "glissade/graph/edge_pool_base.h"

namespace glissade {

struct PooledVertex {
  VertexPoolBase* pool;
  std::uint32_t slot;
};

/// All dynamic edges of a graph, of whatever class.
class DynamicEdgePool final : public EdgePoolBase {
 public:
  DynamicEdgePool();

  using Vertex = PooledVertex;

  EdgeHandle<DynamicEdge> Add(std::unique_ptr<DynamicEdge> edge, std::span<const Vertex> vertices,
                              const Loss& loss, std::uint64_t stamp, std::uint32_t graph);

  /// Takes back the edge that was added last; false if that is another one, or gone.
  bool TakeBack(EdgeHandle<DynamicEdge> edge);

  [[nodiscard]] const DynamicEdge& At(int edge) const { return *EntryAt(edge).edge; }
  [[nodiscard]] DynamicEdge& At(int edge) { return *items_[static_cast<std::size_t>(edge)].edge; }

  /// Takes the edge object out of an edge that has been removed (before the next Compact), so that
  /// its storage can serve again; null if it was taken before. Until Compact its entry is without
  /// one: nothing but Alive() may be asked about edges that are not.
  std::unique_ptr<DynamicEdge> TakeRemoved(int edge) {
    return std::move(items_[static_cast<std::size_t>(edge)].edge);
  }

  [[nodiscard]] int arity(int edge) const override {
    return static_cast<int>(EntryAt(edge).vertices.size());
  }
  [[nodiscard]] int residual_dim(int edge) const override {
    return EntryAt(edge).edge->ResidualDim();
  }
  [[nodiscard]] VertexPoolBase* vertex_pool(int edge, int i) const override {
    return EntryAt(edge).vertices[static_cast<std::size_t>(i)].pool;
  }
  [[nodiscard]] std::uint32_t vertex_slot(int edge, int i) const override {
    return EntryAt(edge).vertices[static_cast<std::size_t>(i)].slot;
  }

  [[nodiscard]] int fixed_arity() const override { return 0; }
  void AllDenseIndices(std::int32_t* indices) const override;
  bool Evaluate(int edge, const double* const* states, double* residual,
                double* const* jacobians) const override;
  void Whiten(int, double*, double* const*) const override {}
  [[nodiscard]] double Chi2(int edge) const override;
  [[nodiscard]] std::vector<double> BatchedChi2() const override;
  bool Depth(int, double*) const override { return false; }
  [[nodiscard]] const double* Extrinsic(int) const override { return nullptr; }
  [[nodiscard]] bool IsDuplicate(int, int) const override { return false; }
  void BeginLinearize(FirstEstimates first_estimates) const override;
  void BeginCost() const override;
  bool Linearize(const std::int32_t* words, int count, NormalEquationsSink* sink) const override;
  bool Cost(const std::int32_t* words, int count, NormalEquationsSink* sink) const override;
  void Prepare() override;
  [[nodiscard]] std::int64_t MemoryBytes() const override;
  void Compact() override;
  [[nodiscard]] std::unique_ptr<EdgePoolBase> Clone(
      const std::vector<std::unique_ptr<VertexPoolBase>>& vertex_pools,
      AnyEdge* failed) const override;

 private:
  struct Entry {
    std::unique_ptr<DynamicEdge> edge;
    std::vector<Vertex> vertices;
    // Scratch of this edge, so that edges can be evaluated side by side without allocating.
    mutable std::vector<VertexRef> refs;
    mutable std::vector<double> residual;
    mutable std::vector<double> jacobian;  // blocks one after the other
    mutable std::vector<double*> jacobian_of_vertex;
    mutable std::vector<double> gradient;
    mutable std::vector<double> points;  // states with first estimates in them, one after the other
    mutable bool batch_has_value = false;  // what its batch said last
  };

  [[nodiscard]] const Entry& EntryAt(int edge) const {
    return items_[static_cast<std::size_t>(edge)];
  }
  void Link(int edge);
  void PrepareItem(Entry* item) const;
  void FillRefs(const Entry& item) const;
  void SetRefs(const Entry& item, const std::int32_t* words) const;
  bool LinearizeConstant(const Entry& item, const std::int32_t* words,
                         NormalEquationsSink* sink) const;
  /// The same in the tangent at the present state of an edge that is linear about another one: with
  /// D = d(x boxminus x0)/dx, vertex by vertex, D'H D and D'g.
  bool LinearizeMoved(const Entry& item, const std::int32_t* words,
                      NormalEquationsSink* sink) const;
  bool LinearizeGeneral(const Entry& item, const Loss& loss, const std::int32_t* words,
                        NormalEquationsSink* sink) const;
  bool EvaluateFirstEstimates(const Entry& item) const;
  /// Moves the refs to where Jacobians are taken with FirstEstimates::kFull.
  static void RefsToFirstEstimates(const Entry& item);
  static void PointAtJacobians(const Entry& item);
  struct Batches;
  [[nodiscard]] Batches FindBatches() const;
  void EvaluateResiduals(Batches* batches) const;
  [[nodiscard]] bool HasBatches() const;
  static void Add(const Entry& item, const std::int32_t* words, const double* H, int stride,
                  const double* gradient, NormalEquationsSink* sink);

  std::vector<Entry> items_;
  std::vector<Entry> spare_;  // of edges that are gone: their vectors serve again
};

}  // namespace glissade
