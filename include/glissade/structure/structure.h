// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/graph/pools.h"
#include "glissade/structure/block_index.h"
#include "glissade/structure/landmark_plan.h"

namespace glissade {

/// A free vertex of the reduced system: one block row and column of S.
struct PoseBlock {
  std::int32_t pool = 0;  ///< vertex pool and dense index
  std::int32_t index = 0;
  std::int32_t offset = 0;         ///< first scalar in b_p and S
  std::int32_t dim = 0;            ///< tangent dimension
  std::int32_t h_diagonal = 0;     ///< offset of its diagonal block in H_pp
  std::int32_t free_tangent = -1;  ///< index in Graph::free_tangents(), -1: wholly free
};

/// A free eliminated vertex. Its record in the landmark buffer is laid out as edge_plan.h says.
struct LandmarkBlock {
  std::int32_t pool = 0;
  std::int32_t index = 0;
  std::int32_t dim = 0;         ///< 1 to 4
  std::int64_t record = 0;      ///< offset of [H_ll | b_l | W ...] in the landmark buffer
  std::int32_t step = 0;        ///< offset of its part of the landmark step
  std::int32_t slot_begin = 0;  ///< its W blocks: slots [slot_begin, slot_end)
  std::int32_t slot_end = 0;
};

/// One stored block of H_pp: row >= col, row-major dim(row) x dim(col).
struct PoseBlockPair {
  std::int32_t row = 0;
  std::int32_t col = 0;
  std::int32_t offset = 0;
};

/// A block of the constant H of a linear edge (a marginal prior).
struct ConstantBlock {
  std::int32_t edge = 0;  ///< index in Structure::constant_edges()
  std::int32_t pair = 0;  ///< index in Structure::h_blocks()
  std::int32_t row = 0;   ///< first row and column in the edge's H
  std::int32_t col = 0;
};

/// Part of a pool's edges: a run of plan records.
struct EdgeRun {
  std::int32_t pool = 0;
  std::int32_t count = 0;
  std::int64_t begin_word = 0;
};

struct StructureOptions {
  bool allow_duplicate_observations = false;
  /// Eliminate landmarks in groups where they qualify (LandmarkPlan). Off for who wants all of H:
  /// groups keep no landmark's part of it.
  bool group_landmarks = true;
  /// Whether the records of edges (Words()) will be read: an analysis that has given them back is
  /// then made again.
  bool needs_records = true;
};

/// What follows from the graph's topology alone: order of the variables, edges per landmark, block
/// sparsity, where each edge adds what, and how the work is cut. States decide one thing only,
/// which landmarks may be in groups (LandmarkPlan::kMaxReach).
///
/// Computed once and kept until the graph's structure changes. The cut into chunks depends on the
/// problem only, never on the number of threads: same input, same bits.
class Structure {
 public:
  /// Analyzes anew if the graph has changed since the last time (compacting it), or if its states
  /// have moved too far apart for groups(); cheap otherwise.
  /// Fails, naming both edges, on an observation that is in the graph twice.
  Status Analyze(Graph* graph, const StructureOptions& options = {});
  /// Of a large problem gives back the memory that the analysis itself took, and the records of
  /// those edges of a pool that `in_runs` says are all evaluated from a plan of somebody's own.
  /// What is left is the analysis still; the next one begins from nothing.
  void ReleaseScratch(const std::vector<bool>& in_runs);
  /// Whether the last analysis was of this graph as it is now.
  [[nodiscard]] bool IsCurrent(const Graph& graph) const {
    return graph_ == graph.identity() && version_ == graph.structure_version();
  }

  [[nodiscard]] const std::vector<PoseBlock>& poses() const { return poses_; }
  /// First scalar of each pose block, and their total at the end.
  [[nodiscard]] const std::vector<std::int32_t>& pose_offsets() const { return pose_offsets_; }
  [[nodiscard]] int num_pose_scalars() const { return pose_offsets_.back(); }
  /// Landmarks that are eliminated one by one; the others are in groups().
  [[nodiscard]] const std::vector<LandmarkBlock>& landmarks() const { return landmarks_; }
  [[nodiscard]] const LandmarkPlan& groups() const { return plan_; }
  [[nodiscard]] int num_landmark_scalars() const { return num_landmark_scalars_; }
  [[nodiscard]] int num_edges() const { return num_edges_; }

  [[nodiscard]] const std::vector<PoseBlockPair>& h_blocks() const { return h_blocks_; }
  [[nodiscard]] std::int64_t h_size() const { return h_size_; }
  /// The part of h_blocks() that is filled anew by each linearization comes first; the other pairs
  /// are known to linear edges alone, whose H does not change.
  [[nodiscard]] std::span<const PoseBlockPair> varying_blocks() const {
    return std::span(h_blocks_).first(num_varying_);
  }
  [[nodiscard]] std::int64_t varying_size() const { return varying_size_; }
  /// Dynamic edges with a constant Hessian, and its blocks of free vertices. Their b and cost are
  /// linearized with all others; this part of H is not added by the linearization.
  [[nodiscard]] const std::vector<std::int32_t>& constant_edges() const { return constant_edges_; }
  [[nodiscard]] const std::vector<ConstantBlock>& constant_blocks() const {
    return constant_blocks_;
  }
  /// Blocks of the lower triangle of the reduced system S that can be non-zero, fill by landmarks
  /// included: by column, rows ascending within one.
  [[nodiscard]] const std::vector<BlockIndex>& reduced_pattern() const { return reduced_pattern_; }
  /// A new number with every analysis that was not skipped, by any Structure; never 0.
  [[nodiscard]] std::uint64_t analysis() const { return analysis_; }
  [[nodiscard]] std::int64_t landmark_buffer_size() const { return landmark_buffer_size_; }
  /// Where the record of each landmark begins in that buffer.
  [[nodiscard]] const std::vector<std::int64_t>& landmark_records() const {
    return landmark_records_;
  }
  /// Pose block of each W slot, ascending within a landmark, with its scalar row and dimension.
  [[nodiscard]] const std::vector<std::int32_t>& slot_block() const { return slot_block_; }
  [[nodiscard]] const std::vector<std::int32_t>& slot_row() const { return slot_row_; }
  [[nodiscard]] const std::vector<std::int32_t>& slot_dim() const { return slot_dim_; }

  /// From so many edges on memory counts for more than the time of another analysis.
  static constexpr int kManyEdges = 100'000;
  [[nodiscard]] bool IsLarge() const { return num_edges_ >= kManyEdges; }
  /// Of what an analysis has left behind (ReleaseScratch()).
  [[nodiscard]] std::int64_t MemoryBytes() const;
  /// What an analysis of the graph will take for itself at least, before anything is known of it.
  [[nodiscard]] static std::int64_t AnalysisBytes(const Graph& graph);

  [[nodiscard]] int num_chunks() const { return num_chunks_; }
  /// Fewer edges than twice that are one chunk.
  static constexpr int kEdgesPerChunk = 1500;
  /// Landmarks of chunk c: [landmark_chunks()[c], landmark_chunks()[c + 1]).
  [[nodiscard]] const std::vector<std::int32_t>& landmark_chunks() const {
    return landmark_chunks_;
  }
  /// Edges of chunk c, pool by pool, in landmark order.
  [[nodiscard]] std::span<const EdgeRun> EdgesOfChunk(int chunk) const {
    const std::size_t pools = num_pools_;
    return {runs_.data() + static_cast<std::size_t>(chunk) * pools, pools};
  }
  [[nodiscard]] const std::int32_t* Words(const EdgeRun& run) const {
    return words_[static_cast<std::size_t>(run.pool)].data() + run.begin_word;
  }
  /// Offset of each vertex's step: pose blocks in [0, num_pose_scalars), landmarks after them;
  /// -1: does not move, or is partly fixed and moved through its chart.
  [[nodiscard]] const std::vector<std::int32_t>& step_offsets(int pool) const {
    return step_offsets_[static_cast<std::size_t>(pool)];
  }

 private:
  struct EdgeRef {
    std::int32_t pool;
    std::int32_t edge;
  };

  void FlattenEdges(const Graph& graph);
  void NumberVariables(const Graph& graph);
  void SortLandmarks();
  Status FindDuplicates(const Graph& graph);
  void ListLandmarkEdges(const Graph& graph);
  void NumberLandmarkSteps();
  void CutIntoChunks();
  void LayOutLandmark(int landmark);
  void WriteEdge(const EdgeRef& ref, int landmark);
  std::int32_t* WriteWords(const EdgeRef& ref);
  void WriteConstantEdges(std::int32_t pool_id, const DynamicEdgePool& pool);
  std::int32_t PairIndex(std::int32_t row, std::int32_t col);
  std::int32_t PairOffset(std::int32_t row, std::int32_t col) {
    return h_blocks_[static_cast<std::size_t>(PairIndex(row, col))].offset;
  }
  void GrowPairTable();
  enum class PoolKind : std::uint8_t { kOther, kHostAndTarget, kPoseAndPoint, kLandmarkOnly };
  void ClassifyPools(const Graph& graph);
  void ListObservers();
  [[nodiscard]] std::int32_t HostOf(std::size_t landmark) const;
  void FindGroups(const Graph& graph);
  void AddGroups(const Graph& graph, PoolKind kind, const TypeInfo* type);
  [[nodiscard]] std::int32_t TrackLength(PoolKind kind, std::int32_t landmark) const;
  void ChooseCenter(const Graph& graph);
  template <class F>
  void KeepGrouped(F&& keeps);
  void LeaveOutFarLandmarks(const Graph& graph);
  void LeaveOutSparseGroups(const Graph& graph);
  [[nodiscard]] bool IsSparse(std::size_t begin, std::size_t end);
  [[nodiscard]] double ReachOfDepths(const Graph& graph, const LandmarkGroup& group) const;
  [[nodiscard]] double ReachOfPoints(const Graph& graph, const LandmarkGroup& group) const;
  [[nodiscard]] double Reach(const Graph& graph) const;
  void PlanGroups(const Graph& graph, bool allow);
  void PlanGroup(const Graph& graph, LandmarkGroup* group, std::size_t begin, std::size_t end);
  std::int32_t FindRun(const Graph& graph, const LandmarkGroup& group, std::int32_t landmark_edge,
                       std::int32_t lane);
  void LayOutGroup(LandmarkGroup* group);
  void FillHoles(const LandmarkRun& run);
  void RemoveGroupedFromLandmarks();
  void FinishPlan();
  std::int32_t PlanBlock(std::int32_t row, std::int32_t col);
  template <class F>
  void ForEachEdgeOf(std::int32_t landmark, F&& f) const {
    const auto l = static_cast<std::size_t>(landmark);
    for (std::int32_t k = landmark_edges_begin_[l]; k < landmark_edges_begin_[l + 1]; ++k) {
      f(landmark_edges_[static_cast<std::size_t>(k)]);
    }
  }
  /// f(pose) of all that observe a landmark in a group.
  template <class F>
  void ForEachObserverOf(std::int32_t landmark, F&& f) const {
    const auto l = static_cast<std::size_t>(landmark);
    for (std::int32_t k = landmark_edges_begin_[l]; k < landmark_edges_begin_[l + 1]; ++k) {
      const std::int32_t pose = observer_[static_cast<std::size_t>(k)];
      if (pose >= 0) f(pose);
    }
  }
  void BuildReducedPattern();
  Status CheckSize(const Graph& graph) const;

  std::uint64_t version_ = 0;
  std::uint64_t graph_ = 0;  // its identity
  bool has_records_ = false;
  bool checked_duplicates_ = false;
  std::vector<PoseBlock> poses_;
  std::vector<std::int32_t> pose_offsets_{0};
  std::vector<LandmarkBlock> landmarks_;
  int num_landmark_scalars_ = 0;
  int num_edges_ = 0;
  std::size_t num_pools_ = 0;
  std::vector<PoseBlockPair> h_blocks_;
  std::int64_t h_size_ = 0;
  std::size_t num_varying_ = 0;
  std::int64_t varying_size_ = 0;
  std::vector<std::int32_t> constant_edges_;
  std::vector<ConstantBlock> constant_blocks_;
  std::vector<BlockIndex> reduced_pattern_;
  LandmarkPlan plan_;
  bool groups_landmarks_ = true;
  std::uint64_t analysis_ = 0;
  std::vector<std::int64_t> landmark_records_;
  std::int64_t landmark_buffer_size_ = 0;
  std::vector<std::int32_t> slot_block_, slot_row_, slot_dim_;
  int num_chunks_ = 1;
  std::vector<std::int32_t> landmark_chunks_;
  std::vector<EdgeRun> runs_;
  std::vector<std::vector<std::int32_t>> words_;
  std::vector<std::vector<std::int32_t>> step_offsets_;

  // Scratch, kept so that an analysis of a problem not larger than before allocates nothing.
  std::vector<std::vector<std::int32_t>> variable_;  // pool, index -> pose block or ~landmark
  std::vector<std::vector<std::uint8_t>> touched_;
  /// Edges of one pool, flat: dense vertex indices and, once numbered, variables (pose block,
  /// ~landmark or kInactive), those of edge e in [begin(e), begin(e + 1)).
  struct FlatEdges {
    int arity = 0;                    // 0: varies, begin tells
    std::vector<std::int32_t> begin;  // only where the arity varies
    std::vector<std::int32_t> index;
    std::vector<std::int32_t> pool;  // of each position; arity entries, or one per index
    std::vector<std::int32_t> variable;

    [[nodiscard]] int Begin(int edge) const {
      return arity > 0 ? edge * arity : begin[static_cast<std::size_t>(edge)];
    }
    /// f(vertex pool, first, step): of index and variable, those of the pool are every step-th.
    template <class F>
    void ForEachPool(F&& f) const {
      const std::size_t step = arity > 0 ? pool.size() : index.size();
      for (std::size_t i = 0; i < pool.size(); ++i)
        f(static_cast<std::size_t>(pool[i]), i, step);
    }
    [[nodiscard]] int Arity(int edge) const {
      return arity > 0 ? arity
                       : begin[static_cast<std::size_t>(edge) + 1] -
                             begin[static_cast<std::size_t>(edge)];
    }
  };
  std::vector<FlatEdges> flat_;
  std::vector<EdgeRef> landmark_edges_;  // edges by landmark, then edges without one
  std::vector<std::int32_t> landmark_edges_begin_;
  std::vector<std::int32_t> fill_;
  struct SeenLandmark {
    std::int32_t pool, first, last, landmark;  // pose blocks that see it
  };
  std::vector<SeenLandmark> order_;
  std::vector<LandmarkBlock> unsorted_;
  std::vector<std::int32_t> new_number_, edges_of_pose_;
  std::vector<std::int32_t> slot_of_block_, stamp_of_block_;
  std::vector<std::int32_t> pair_table_;  // open addressing: index in h_blocks_, or -1
  std::vector<EdgeRef> duplicate_table_;
  std::vector<std::int32_t> column_begin_, column_rows_;   // of the reduced pattern, unsorted
  std::vector<std::int32_t> seen_begin_, seen_landmarks_;  // of each pose block
  struct GroupedLandmark {
    std::int32_t group, length, landmark;
  };
  std::vector<GroupedLandmark> grouped_;
  std::vector<PoolKind> pool_kind_;
  // By landmark_edges_ as they are before groups are taken out: the pose that observes the landmark
  // (the target, or the pose of a point), kNoObserver of an edge on the landmark alone, kNoGroup of
  // one whose landmark may not be in a group.
  static constexpr std::int32_t kNoObserver = -1, kNoGroup = -2;
  std::vector<std::int32_t> observer_;
  std::vector<std::int32_t> newest_run_, next_run_, first_edge_, run_of_edge_, moved_pair_;
  std::vector<double> distance_;  // of each pose from the center
  struct WeightedCoordinate {
    double value;
    std::int64_t landmarks;
  };
  std::vector<WeightedCoordinate> coordinates_;
  std::vector<std::uint8_t> is_grouped_, is_sparse_;
  std::vector<std::int32_t> group_of_host_, pair_of_pose_, frames_, last_lanes_, chain_of_row_,
      next_in_row_;
};

}  // namespace glissade
