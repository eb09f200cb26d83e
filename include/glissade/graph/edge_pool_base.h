// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "glissade/edges/edge_ops.h"
#include "glissade/edges/lane_run.h"
#include "glissade/graph/edge_lists.h"
#include "glissade/graph/edge_plan.h"
#include "glissade/graph/slot_map.h"
#include "glissade/graph/vertex_pool.h"
#include "glissade/losses/loss.h"

namespace glissade {

/// All edges of one type (or all dynamic edges), as the modules below the graph see them.
class EdgePoolBase {
 public:
  /// arity: of all its edges, 0 if it differs.
  EdgePoolBase(const TypeInfo* type, const EdgeTraits& traits, int arity)
      : type_(type), traits_(&traits), evaluate_lanes_(LibraryEvaluator(type)), lists_(arity) {}
  virtual ~EdgePoolBase();

  [[nodiscard]] const TypeInfo* type() const { return type_; }
  [[nodiscard]] const EdgeTraits& traits() const { return *traits_; }
  [[nodiscard]] bool IsObservation() const { return traits_->is_observation; }
  [[nodiscard]] const internal::SlotMap& slots() const { return slots_; }
  [[nodiscard]] int size() const { return slots_.Size(); }
  [[nodiscard]] AnyEdge HandleAt(int edge) const {
    const std::uint32_t slot = slots_.SlotOf(edge);
    return {type_, slot, slots_.GenerationOf(slot), slots_.GraphOf(slot)};
  }
  [[nodiscard]] const Loss& loss(int edge) const {
    return losses_[loss_of_edge_[static_cast<std::size_t>(edge)]];
  }
  void set_loss(int edge, const Loss& loss) {
    loss_of_edge_[static_cast<std::size_t>(edge)] = FindOrAddLoss(loss);
  }

  [[nodiscard]] virtual int arity(int edge) const = 0;
  [[nodiscard]] virtual int residual_dim(int edge) const = 0;
  /// Pool and slot of the i-th vertex of an edge.
  [[nodiscard]] virtual VertexPoolBase* vertex_pool(int edge, int i) const = 0;
  [[nodiscard]] virtual std::uint32_t vertex_slot(int edge, int i) const = 0;
  /// Number of vertices where it is the same for all edges of the pool, else 0.
  [[nodiscard]] virtual int fixed_arity() const = 0;
  /// Dense indices of all vertices of all edges (live ones: after Compact), one after the other.
  virtual void AllDenseIndices(std::int32_t* indices) const = 0;
  /// The i-th vertex of an edge that is alive.
  [[nodiscard]] AnyVertex VertexOf(int edge, int i) const {
    const std::uint32_t slot = vertex_slot(edge, i);
    const VertexPoolBase* pool = vertex_pool(edge, i);
    return {pool->ops().type, slot, pool->slots().GenerationOf(slot), pool->slots().GraphOf(slot)};
  }
  /// Not removed, by itself or with one of its vertices.
  [[nodiscard]] bool Alive(int edge) const { return slots_.AliveAt(edge); }
  void Remove(std::uint32_t slot) { slots_.Remove(slot); }

  /// f(edge) for each edge at a vertex, youngest first: as many steps as there are, and were since
  /// the last Compact().
  template <class F>
  void ForEachEdgeAt(const VertexPoolBase& vertices, std::uint32_t slot, F&& f) const {
    for (auto link = lists_.First(&vertices, slot); link >= 0; link = lists_.Next(link)) {
      if (const int edge = lists_.EdgeOf(link); slots_.AliveAt(edge)) f(edge);
    }
  }
  /// Removes the edges at a vertex, which goes.
  void RemoveEdgesAt(const VertexPoolBase& vertices, std::uint32_t slot) {
    ForEachEdgeAt(vertices, slot, [&](int edge) { slots_.Remove(slots_.SlotOf(edge)); });
    lists_.Drop(&vertices, slot);
  }

  /// Raw residual (unweighted) and Jacobians (row-major, in the full tangent; null pointers or a
  /// null array skip them) at the given states. False where the edge has no finite value.
  virtual bool Evaluate(int edge, const double* const* states, double* residual,
                        double* const* jacobians) const = 0;
  /// The same with first estimates: points[i] is x_lin of vertex i (all of its numbers), or null
  /// where it has none. The residual is that of the states; Jacobians are taken as the edge's
  /// FirstEstimateRule says.
  bool EvaluateAt(int edge, const double* const* states, const double* const* points,
                  double* residual, double* const* jacobians) const;
  /// Values of the edges of a run in lanes. Returns the lane of the first edge without one, or -1.
  int EvaluateRun(const LaneRun& run, const LaneValues& values,
                  FirstEstimates first_estimates) const;
  /// Whether two edges on the same vertices but for the landmark may be in one run.
  [[nodiscard]] virtual bool SameInRun(int, int) const { return true; }
  /// L (rows x rows, row-major), null where it is the identity.
  [[nodiscard]] virtual const double* whitening(int) const { return nullptr; }
  /// The edges themselves, for evaluate_lanes.
  [[nodiscard]] virtual const void* edges() const { return nullptr; }
  /// Whether EvaluateRun takes several edges at once.
  [[nodiscard]] bool evaluates_in_packs() const { return evaluate_lanes_ != nullptr; }
  /// How to evaluate edges in packs, for types that can: the library's own way for its own types,
  /// else that of the unit that first adds one.
  void set_evaluate_lanes(EvaluateLanes function) {
    if (evaluate_lanes_ == nullptr) evaluate_lanes_ = function;
  }
  /// residual <- L residual, jacobians <- L jacobians.
  virtual void Whiten(int edge, double* residual, double* const* jacobians) const = 0;
  /// s = r' Omega r at the present states; NaN where the edge has no finite value.
  [[nodiscard]] virtual double Chi2(int edge) const = 0;
  /// The same of all edges, by position, where they are evaluated together (edges/edge_batch.h);
  /// NaN for removed ones and those that are evaluated alone. Empty: each is asked alone.
  [[nodiscard]] virtual std::vector<double> BatchedChi2() const { return {}; }
  /// Depth of the observed point in the observing camera [m]; false if the type has none.
  virtual bool Depth(int edge, double* depth) const = 0;
  /// T_b_c that an edge carries, 7 numbers; null if it has none, or has it as a vertex
  /// (traits().extrinsic_vertex).
  [[nodiscard]] virtual const double* Extrinsic(int edge) const = 0;
  /// What an edge that is a reprojection between ideal cameras has; false for other types.
  virtual bool TwoView(int, TwoViewObservation*) const { return false; }
  /// Two edges on the same vertices that are one observation counted twice.
  [[nodiscard]] virtual bool IsDuplicate(int edge, int other) const = 0;

  /// Comes before Linearize or Cost of all edges, at the present states, on the caller's thread:
  /// evaluates what is evaluated together.
  virtual void BeginLinearize(FirstEstimates) const {}
  virtual void BeginCost() const {}
  /// Adds H, b and cost of count edges (typed ones: without a free landmark), whose plan records
  /// (edge_plan.h) start at words. Returns false at the first edge without a finite value, named in
  /// sink->failed_edge.
  virtual bool Linearize(const std::int32_t* words, int count, NormalEquationsSink* sink) const = 0;
  /// The same, cost only.
  virtual bool Cost(const std::int32_t* words, int count, NormalEquationsSink* sink) const = 0;
  /// Sizes the scratch that Linearize needs. Called once per analysis.
  virtual void Prepare() {}

  /// About what the edges and their handles take.
  [[nodiscard]] virtual std::int64_t MemoryBytes() const = 0;

  /// Closes the gaps that removed edges have left; nothing where there are none.
  virtual void Compact() = 0;
  /// A copy whose edges refer to the given vertex pools (same types, same slots). Null, with the
  /// edge in *failed, where an edge cannot be copied.
  [[nodiscard]] virtual std::unique_ptr<EdgePoolBase> Clone(
      const std::vector<std::unique_ptr<VertexPoolBase>>& vertex_pools, AnyEdge* failed) const = 0;

 protected:
  EdgePoolBase(const EdgePoolBase&) = default;
  std::uint32_t FindOrAddLoss(const Loss& loss);

  static EvaluateLanes LibraryEvaluator(const TypeInfo* type);
  int EvaluateOneByOne(const LaneRun& run, const LaneValues& values) const;
  int EvaluateRelative(const LaneRun& run, const LaneValues& values, EvaluateLanes evaluate) const;
  [[nodiscard]] bool HasMoved(const LaneRun& run) const;

  const TypeInfo* type_;
  const EdgeTraits* traits_;
  EvaluateLanes evaluate_lanes_;
  internal::SlotMap slots_;
  internal::EdgeLists lists_;
  std::vector<Loss> losses_;
  std::vector<std::uint32_t> loss_of_edge_;
};

}  // namespace glissade
