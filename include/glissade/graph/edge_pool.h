// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "glissade/base/index.h"
#include "glissade/base/value_array.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/graph/edge_pool_base.h"

namespace glissade {

/// All edges of one typed kind: values, vertices, weights. It knows the type by its EdgeOps, so
/// that an edge type costs the unit that adds it no more to compile than these.
class EdgePool final : public EdgePoolBase {
 public:
  /// vertex_pools: of a graph that has all vertex types of the edge.
  EdgePool(const EdgeOps& ops, const std::vector<std::unique_ptr<VertexPoolBase>>& vertex_pools);
  EdgePool(const EdgePool&) = default;

  /// An edge on vertices that are alive. sqrt_information: rows x rows, row-major. Reserve() comes
  /// first; where the copy of the edge or of a new loss throws nonetheless, nothing has been added.
  AnyEdge Add(const void* edge, const AnyVertex* vertices, const double* sqrt_information,
              bool identity, const Loss& loss, std::uint64_t stamp, std::uint32_t graph);
  /// All of the edge's types, alive and different, at most one of them eliminated.
  [[nodiscard]] bool CanJoin(const AnyVertex* vertices) const;
  /// Room for `count` more edges, of which some have another weight than the identity unless
  /// `identity`; then, for each, RoomAt(): adding it will not allocate.
  void Reserve(std::size_t count, bool identity);
  void RoomAt(const AnyVertex* vertices);

  [[nodiscard]] const void* Value(int edge) const { return edges_.At(internal::Index(edge)); }
  /// E: the pool's type.
  template <class E>
  [[nodiscard]] const E& At(int edge) const {
    return static_cast<const E*>(edges_.data())[edge];
  }
  template <class E>
  [[nodiscard]] E& At(int edge) {
    return static_cast<E*>(edges_.data())[edge];
  }
  /// rows x rows, row-major. Of an edge with HasIdentityInformation() it may not be there.
  [[nodiscard]] const double* sqrt_information(int edge) const {
    return sqrt_information_.data() + internal::Index(edge) * internal::Index(rows_ * rows_);
  }
  [[nodiscard]] bool HasIdentityInformation(int edge) const {
    return identity_[internal::Index(edge)] != 0;
  }
  void set_sqrt_information(int edge, const double* value, bool identity);

  [[nodiscard]] int arity(int) const override { return arity_; }
  [[nodiscard]] int residual_dim(int) const override { return rows_; }
  [[nodiscard]] VertexPoolBase* vertex_pool(int, int i) const override { return pools_[i]; }
  [[nodiscard]] std::uint32_t vertex_slot(int edge, int i) const override {
    return vertices_[internal::Index(edge) * internal::Index(arity_) + internal::Index(i)];
  }
  [[nodiscard]] int fixed_arity() const override { return arity_; }
  void AllDenseIndices(std::int32_t* indices) const override;
  bool Evaluate(int edge, const double* const* states, double* residual,
                double* const* jacobians) const override;
  [[nodiscard]] const double* whitening(int edge) const override {
    return HasIdentityInformation(edge) ? nullptr : sqrt_information(edge);
  }
  [[nodiscard]] bool SameInRun(int edge, int other) const override;
  [[nodiscard]] const void* edges() const override { return edges_.data(); }
  void Whiten(int edge, double* residual, double* const* jacobians) const override;
  [[nodiscard]] double Chi2(int edge) const override;
  bool Depth(int edge, double* depth) const override;
  [[nodiscard]] const double* Extrinsic(int edge) const override;
  bool TwoView(int edge, TwoViewObservation* observation) const override;
  [[nodiscard]] bool IsDuplicate(int edge, int other) const override;
  bool Linearize(const std::int32_t* words, int count, NormalEquationsSink* sink) const override;
  bool Cost(const std::int32_t* words, int count, NormalEquationsSink* sink) const override;
  [[nodiscard]] std::int64_t MemoryBytes() const override;
  void Compact() override;
  [[nodiscard]] std::unique_ptr<EdgePoolBase> Clone(
      const std::vector<std::unique_ptr<VertexPoolBase>>& vertex_pools,
      AnyEdge* failed) const override;

 private:
  void KeepWeights();
  void Bind(const std::vector<std::unique_ptr<VertexPoolBase>>& vertex_pools);
  void Link(int edge);
  void DenseIndices(int edge, std::int32_t* indices) const;
  void States(const std::int32_t* indices, const double** states) const;
  [[nodiscard]] double WhitenedSquaredNorm(int edge, const double* const* states,
                                           double* scratch) const;
  /// Numbers that one linearization needs room for.
  [[nodiscard]] int ScratchSize() const;
  bool LinearizeOne(const std::int32_t* words, double* scratch, NormalEquationsSink* sink) const;
  bool AccumulateWide(const std::int32_t* words, const double* r, const double* const* jacobians,
                      double* scratch, NormalEquationsSink* sink) const;
  void Accumulate(const std::int32_t* words, const double* r, const double* const* jacobians,
                  NormalEquationsSink* sink) const;

  const EdgeOps* ops_;
  int arity_, rows_;
  int dims_ = 0;  // of all tangents
  bool wide_;     // worth the vector kernels: many rows between large vertices (IMU terms: 15 x 31)
  int dim_[kMaxTypedArity];
  VertexPoolBase* pools_[kMaxTypedArity];
  int column_[kMaxTypedArity];  // of lists_: one for each vertex type
  internal::ValueArray edges_;
  std::vector<std::uint32_t> vertices_;  // slots, arity_ for each edge
  /// rows_ x rows_ for each edge; empty as long as all weights are the identity.
  std::vector<double> sqrt_information_;
  std::vector<std::uint8_t> identity_;
};

}  // namespace glissade
