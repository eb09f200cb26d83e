// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/graph/pools.h"
#include "glissade/linear/normal_equations.h"
#include "linear/lane_weights.h"

namespace glissade {

/// The edges of landmarks in lanes: edges of one type on the same vertices, but for the landmark,
/// make a run. A pool evaluates a run into arrays with one number per edge; weights, losses and the
/// sums that go into H and b are then the same code for every type of edge (the kernels on lanes).
///
/// Takes all typed edges on a free landmark that is in no group; the others go edge by edge
/// (EdgePoolBase::Linearize).
class LandmarkRuns {
 public:
  /// Sorts the edges into runs, once per analysis; weights also where they changed.
  void Plan(const Structure& structure, const Graph& graph);

  /// How many of the records of edges that begin a chunk's part of a pool are in runs.
  [[nodiscard]] std::int32_t Taken(int chunk, int pool) const {
    return taken_[static_cast<std::size_t>(chunk) * num_pools_ + static_cast<std::size_t>(pool)];
  }
  [[nodiscard]] bool IsPlanned(const Structure& structure) const {
    return analysis_ != 0 && analysis_ == structure.analysis();
  }
  /// Packs of a chunk's part of a pool whose edges were evaluated once more, one by one, because
  /// lanes disagreed about a condition; since ForgetRedone().
  [[nodiscard]] std::int64_t Redone(int chunk, int pool) const {
    return redone_[static_cast<std::size_t>(chunk) * num_pools_ + static_cast<std::size_t>(pool)];
  }
  /// Of all runs of a pool, with padding.
  [[nodiscard]] std::int64_t Lanes(int pool) const {
    std::int64_t lanes = 0;
    for (const Run& run : runs_)
      lanes += run.pool == pool ? run.lanes : 0;
    return lanes;
  }
  /// Of the plan.
  [[nodiscard]] std::int64_t MemoryBytes() const {
    return static_cast<std::int64_t>(
        runs_.capacity() * sizeof(Run) + (edge_.capacity() + landmark_.capacity()) * 4 +
        (record_.capacity() + h_block_.capacity() + w_.capacity()) * 8 +
        vertex_.capacity() * sizeof(Vertex) + added_.capacity() * sizeof(Added));
  }
  void ForgetRedone() { redone_.assign(redone_.size(), 0); }
  /// Before a linearization: zeros in what is added to, of a chunk's landmarks. Most of it, W, is
  /// set by the runs.
  void ZeroRecords(const Structure& structure, int chunk, double* landmarks) const;
  /// Adds the chunk's part of H, b and cost. False where an edge has no finite value: *pool and
  /// sink->failed_edge tell which.
  bool Linearize(const Graph& graph, int chunk, NormalEquationsSink* sink, std::int32_t* pool);
  /// The same, cost only.
  bool Cost(const Graph& graph, int chunk, NormalEquationsSink* sink, std::int32_t* pool);

 private:
  struct Run {
    std::int32_t pool = 0;
    std::int32_t rows = 0;
    std::int32_t arity = 0;
    std::int32_t landmark = 0;      ///< which of the vertices
    std::int32_t count = 0;         ///< edges
    std::int32_t lanes = 0;         ///< rounded up to kernels::kLaneBlock
    std::int64_t lane_begin = 0;    ///< in edge_, landmark_, record_
    std::int64_t vertex_begin = 0;  ///< in vertex_: `arity` of them
    std::int64_t pair_begin = 0;    ///< in h_block_: plan::NumPairs(arity) offsets
    std::int64_t w_begin = 0;       ///< in w_: `lanes` offsets for each vertex but the landmark
    std::uint32_t sets = 0;         ///< bit i: its blocks of vertex i are the first ones there
    LaneWeights::Run weights;

    /// In w_: the offsets of a vertex that is not the landmark.
    [[nodiscard]] std::int64_t WBegin(int vertex) const {
      return w_begin + std::int64_t{vertex - (vertex > landmark ? 1 : 0)} * lanes;
    }
  };
  struct Vertex {
    std::int32_t index = 0;  ///< in its pool; of the landmark: -1
    std::int32_t dim = 0;
    std::int32_t target = 0;  ///< as plan::Target
  };
  struct Item {
    std::uint64_t key;
    const std::int32_t* words;
    [[nodiscard]] bool operator<(const Item& other) const {
      return key != other.key ? key < other.key : words < other.words;
    }
  };
  /// Values of one run and what weighing them needs; one per chunk.
  struct Scratch {
    std::vector<double> values, work, factor;
    LaneWeights::Scratch weights;
    std::vector<const double*> states, points;  // of the landmarks of a run
    std::int64_t* redone = nullptr;             // of the chunk, per pool
  };
  struct Values {
    double* r = nullptr;
    double* J[kMaxTypedArity] = {};
    std::int64_t count = 0;  ///< numbers, from r on
  };

  void PlanPool(const EdgePoolBase& pool, int id, int arity, const std::int64_t* records);
  void AddRun(const EdgePoolBase& pool, int id, int arity, const std::int64_t* records,
              const Item* items, int count);
  void FindFirst(Run* run);
  void PlanWeights(const Graph& graph);
  Values Place(const Run& run, bool jacobians, Scratch* scratch) const;
  /// Raw values; returns the number of the first edge without one, or -1.
  int Evaluate(const Graph& graph, const Run& run, const Values& values,
               FirstEstimates first_estimates, Scratch* scratch) const;
  /// Whitens and weighs the values; adds to the cost. Returns the first edge whose cost is not
  /// finite, or -1.
  int Weigh(const Graph& graph, const Run& run, const Values& values, Scratch* scratch,
            double* cost) const;
  void Accumulate(const Run& run, const Values& values, NormalEquationsSink* sink) const;
  bool Fail(const Run& run, int lane, NormalEquationsSink* sink, std::int32_t* pool) const;

  std::uint64_t analysis_ = 0;
  std::uint64_t weights_version_ = 0;
  std::size_t num_pools_ = 0;
  std::vector<std::int32_t> taken_;
  std::vector<std::int64_t> redone_;
  std::vector<Run> runs_;
  std::vector<std::int32_t> chunk_begin_;  // runs of chunk c: [chunk_begin_[c], chunk_begin_[c+1])
  std::vector<std::int32_t> edge_;         // per lane; of padding: as the lane before it
  std::vector<std::int32_t> landmark_;     // dense index
  std::vector<std::int64_t> record_;       // offset of its record
  std::vector<Vertex> vertex_;
  std::vector<std::int64_t> h_block_, w_;
  /// Blocks of W that only runs add to which do not set them: offset and size.
  struct Added {
    std::int64_t offset;
    std::int32_t size;
  };
  std::vector<Added> added_;
  std::vector<std::int32_t> added_begin_;  // by chunk
  std::vector<std::uint8_t> adds_to_all_;  // by chunk: there are edges that are in no run
  std::vector<bool> is_written_;           // by offset of a block
  LaneWeights weights_;
  std::vector<Scratch> scratch_;
  std::vector<Item> items_, rest_;
  std::size_t max_values_ = 0, max_work_ = 0, max_rows_ = 0;
};

}  // namespace glissade
