// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/graph/pools.h"
#include "glissade/linear/normal_equations.h"
#include "kernels/kernels.h"
#include "linear/aligned.h"
#include "linear/lane_weights.h"
#include "linear/schur_storage.h"

namespace glissade {

/// The landmarks of a LandmarkPlan, from residuals to the Schur complement and back.
///
/// Edges of any type are evaluated in lanes; of their Jacobians the landmark's and the target's are
/// taken, of points the landmark's alone (kernels/points.h). Poses are linearized as twists about
/// the position o of the plan's center, in which one 6-vector per residual serves host and target
/// (kernels/twists.h); sums over landmarks are mapped to the public tangent block by block, with xi
/// = T [dp; dtheta], T = [I, [p - o]x R; 0, R]. With first estimates in full, p and R are those of
/// x_lin: the residual's change by the relative pose stays that at x.
class TwistTerms {
 public:
  /// Weights and losses as arrays, and room for all values; once per analysis, and where weights
  /// changed.
  void Pack(const Structure& structure, const Graph& graph);

  /// Poses at the graph's present values, for Linearize and Cost.
  void UpdatePoses(const Structure& structure, const Graph& graph);
  /// Frames and maps at the same values, for Linearize. Not for Cost: after a rejected step what is
  /// eliminated once more is still the old linearization.
  void UpdateFrames(const Structure& structure, const Graph& graph);
  /// Adds a chunk's part of H_pp, b_p and cost; h and b_l of its lanes are kept here. False where
  /// an edge has no finite value: *pool and sink->failed_edge tell which.
  bool Linearize(const Structure& structure, const Graph& graph, int chunk,
                 NormalEquationsSink* sink, std::int32_t* pool);
  /// The same, cost only.
  bool Cost(const Structure& structure, const Graph& graph, int chunk, NormalEquationsSink* sink,
            std::int32_t* pool);
  /// The diagonal of H_ll and b_l of all groups, in the order of their step.
  void FillDiagonal(const Structure& structure, double* diagonal, double* b) const;

  /// Of all runs of a pool: edges, and lanes with padding.
  [[nodiscard]] std::int64_t Edges(const Structure& structure, int pool) const;
  [[nodiscard]] std::int64_t Lanes(const Structure& structure, int pool) const;
  /// Packs of a pool's edges that were evaluated once more, one by one, because lanes disagreed
  /// about a condition; since ForgetRedone().
  [[nodiscard]] std::int64_t Redone(int pool) const;
  void ForgetRedone();

  /// The chunk's part of the Schur complement, in twists. Returns the lane of a landmark that
  /// cannot be eliminated, or -1.
  int Eliminate(const Structure& structure, const DampingTerm& damping, int chunk);
  /// Takes the sum over chunks to the tangent and adds it to S and b_s; places: of the plan's
  /// blocks in S. P projects partly fixed poses.
  void AddReduced(const Structure& structure, const Graph& graph, ThreadPool* threads,
                  const std::vector<BlockPlace>& places, double* S, double* b_s);
  /// y -= W H_ll^-1 W' x of a chunk, after AddReduced.
  void SubtractProduct(const Structure& structure, const double* x, int chunk, double* y);
  void BackSubstitute(const Structure& structure, const std::vector<double>& dx, int chunk,
                      double* step);
  /// sum over lanes of dl (2 W'dp + h dl): these landmarks' part of d'H d. T P of the last
  /// Linearize.
  double QuadraticForm(const Structure& structure, const Graph& graph,
                       const std::vector<double>& d);

 private:
  /// Residual, and Jacobians by the landmark and by the target.
  static constexpr int kColumns = 8;
  /// A part of a LandmarkRun whose values stay in the first-level cache.
  struct Segment {
    std::int32_t run = 0;
    std::int32_t first = 0;  ///< slot of the run
    std::int32_t lane = 0;   ///< of the group
    std::int32_t lanes = 0;
    std::int32_t count = 0;   ///< lanes that are evaluated
    bool masked = false;      ///< some of these repeat others
    bool sets_force = false;  ///< the first of its target, for all lanes of it
    /// Reprojections between ideal cameras: these, in cameras_, of points the target's alone. -1:
    /// others.
    std::int32_t host_camera = -1, target_camera = -1;
    std::int64_t uv = 0;           ///< their measurements in uv_
    bool in_one = false;           ///< their values need not be written down: weights are factors
    double scale[2] = {1.0, 1.0};  ///< these, of rows in normalized coordinates
    LaneWeights::Run weights;
  };
  /// 6 x 6 row-major with rows of 8.
  struct Map {
    double T[48] = {};
  };
  /// A sum of [f; q][f; q]' and of r [f; q], as the kernel packs it.
  struct TwistSum {
    static constexpr int kGradient = 21;  ///< where the vector begins
    double x[kernels::kTwistSums] = {};
    bool used = false;
    void Add(const TwistSum& other, double sign_of_gradient) {
      for (int i = 0; i < kGradient; ++i)
        x[i] += other.x[i];
      for (int i = kGradient; i < kGradient + 6; ++i)
        x[i] += sign_of_gradient * other.x[i];
      used = true;
    }
    /// 6 x 6.
    void Unpack(double* H) const {
      for (int i = 0, k = 0; i < 6; ++i) {
        for (int j = 0; j <= i; ++j, ++k)
          H[6 * i + j] = H[6 * j + i] = x[k];
      }
    }
  };
  struct Chunk {
    AlignedDoubles values, work;
    std::vector<const double*> states, points;  // of the landmarks of a segment; points: null
    AlignedDoubles pull;                        // g (kernels/points.h) of a group's pairs
    LaneWeights::Scratch weights;
    std::vector<std::int64_t> redone;  // by pool
    std::vector<TwistSum> pairs, frames;
    AlignedDoubles panel, reduced, blocks, twist_rhs, twists, product, steps, sums;
  };
  /// A chunk's part of a block of the plan.
  struct ChunkBlock {
    std::int32_t chunk = 0;
    std::int32_t index = 0;  ///< among those of the chunk
  };
  /// Of PlanBlocks().
  struct PlanScratch {
    std::vector<std::int32_t> newest;      // of a block of the plan: the last chunk that has it
    std::vector<std::int32_t> index;       // and its number there
    std::vector<std::int32_t> plan_block;  // of each block of a chunk, one chunk after the other
    std::vector<std::int32_t> next;        // in chunk_blocks_
  };
  /// A camera on a pose.
  struct Camera {
    std::int32_t pose = -1;  ///< dense index
    std::int32_t next = -1;  ///< the one of that pose before it
    Pose T_b_c;
    kernels::TwoViewCamera at;
    kernels::TwistFrame frame;
  };
  /// Where the values of a segment are.
  struct Values {
    double* r = nullptr;
    double* J_l = nullptr;
    double* J = nullptr;
    std::int64_t count = 0;  ///< numbers, from r on
  };

  void PackRun(const LandmarkPlan& plan, const Graph& graph, const LandmarkGroup& group,
               std::int32_t run);
  void PackTwoViews(const LandmarkPlan& plan, const EdgePoolBase& pool, const LandmarkGroup& group,
                    Segment* segment);
  std::int32_t FindCamera(std::int32_t pose, const double* T_b_c);
  [[nodiscard]] const kernels::TwistFrame& FrameOf(const Segment& segment, std::int32_t pose) const;
  bool LinearizeGroup(const LandmarkPlan& plan, const Graph& graph, int group,
                      NormalEquationsSink* sink, Chunk* chunk, std::int32_t* pool);
  /// Evaluates a segment and adds to the sums. Returns the first lane without a finite value, or
  /// -1.
  int AddValues(const LandmarkPlan& plan, const Graph& graph, const LandmarkGroup& group,
                const Segment& segment, const kernels::TwistTotals& totals, Chunk* chunk,
                double* cost) const;
  /// The same for a group of points.
  bool LinearizePoints(const LandmarkPlan& plan, const Graph& graph, int group,
                       NormalEquationsSink* sink, Chunk* chunk, std::int32_t* pool);
  int AddPointValues(const LandmarkPlan& plan, const Graph& graph, const LandmarkGroup& group,
                     const Segment& segment, const kernels::PointTotals& totals, Chunk* chunk,
                     double* cost) const;
  [[nodiscard]] kernels::PointTotals PointTotalsOf(const LandmarkPlan& plan,
                                                   const LandmarkGroup& group,
                                                   const Segment& segment, Chunk* chunk);
  void AddGroup(const Structure& structure, int group, double* h_pp, Chunk* chunk);
  void AddFrames(const Structure& structure, const Chunk& chunk, double* h_pp, double* b_p) const;
  /// Columns of the Jacobians by the landmark and by the target; 0: not wanted.
  static Values Place(const Segment& segment, int landmark, int target, Chunk* chunk);
  /// Values weighed but for `factors`, and their cost. Returns the first lane without a finite one,
  /// or -1.
  int Evaluate(const LandmarkPlan& plan, const Graph& graph, const LandmarkGroup& group,
               const Segment& segment, const Values& values, Chunk* chunk, double* cost,
               LaneWeights::Factors* factors) const;
  /// As they are; returns the first lane without one, or -1.
  int EvaluateRaw(const LandmarkPlan& plan, const Graph& graph, const LandmarkGroup& group,
                  const Segment& segment, const Values& values, Chunk* chunk) const;
  /// Landmarks of a group's lanes, which two views take.
  void FillStates(const LandmarkPlan& plan, const Graph& graph, const LandmarkGroup& group);
  /// Where points of a group are linearized.
  void FillPoints(const LandmarkPlan& plan, const Graph& graph, const LandmarkGroup& group);
  [[nodiscard]] kernels::TwoViewRun TwoViewsOf(const LandmarkPlan& plan, const LandmarkGroup& group,
                                               const Segment& segment) const;
  [[nodiscard]] kernels::PointViewRun PointViewsOf(const LandmarkPlan& plan,
                                                   const LandmarkGroup& group,
                                                   const Segment& segment) const;
  [[nodiscard]] kernels::TwoViewWeights TwoViewWeightsOf(const Segment& segment) const;
  /// Of a segment that is `in_one`.
  [[nodiscard]] double CostInOne(const LandmarkPlan& plan, const LandmarkGroup& group,
                                 const Segment& segment) const;
  /// Tells whose value it is.
  static bool Fail(const LandmarkPlan& plan, const Segment& segment, int lane,
                   NormalEquationsSink* sink, std::int32_t* pool);
  /// Numbers the plan's blocks by chunk.
  void PlanBlocks(const Structure& structure);
  [[nodiscard]] const double* BlockOf(const ChunkBlock& block) const;
  void AddMapped(const Structure& structure, const Graph& graph, const LandmarkPlanBlock& block,
                 const double* sum, double* S, std::int64_t stride) const;
  void ProjectMaps(const Structure& structure, const Graph& graph);
  void AddRhs(const Structure& structure, std::int32_t block, double* b_s) const;
  void FillTwists(const Structure& structure, const double* x, int group, Chunk* chunk) const;

  std::uint64_t analysis_ = 0;
  std::uint64_t weights_version_ = 0;
  std::vector<Segment> segments_;
  std::vector<std::int32_t> segment_begin_;  // by group
  LaneWeights weights_;
  std::vector<kernels::TwistGroup> groups_;
  std::vector<kernels::TwistTarget> targets_;
  // As kernels::TwistGroup says: of a group, force_ begins at 6 times the lanes of the pairs
  // before, h_ and factor_ (C of the last elimination) at h_begin_, the others at its step_begin.
  AlignedDoubles force_, h_, factor_, b_, beta_;
  AlignedDoubles state_;  // landmarks as they are, points as seen from origin_
  AlignedDoubles point_;  // where points are linearized, as seen from o
  std::vector<std::int32_t> h_begin_;
  Vector3 origin_ = Vector3::Zero();         // the center's position
  Vector3 linearized_at_ = Vector3::Zero();  // o: the same, or its first estimate
  std::size_t max_values_ = 0, max_work_ = 0, max_rows_ = 0;
  std::vector<std::uint8_t> has_run_, force_is_set_;  // by pair
  AlignedDoubles uv_;
  std::vector<std::int32_t> chunk_map_;        // as the plan's block_map, with the chunk's blocks
  std::vector<std::int32_t> blocks_of_chunk_;  // how many
  std::vector<ChunkBlock> chunk_blocks_;       // by block of the plan and chunk
  std::vector<std::int32_t> chunk_blocks_begin_;
  PlanScratch plan_scratch_;
  std::vector<Camera> cameras_;              // those that two views are seen by
  std::vector<std::int32_t> newest_camera_;  // of each pose, -1: none
  std::vector<kernels::TwistFrame> frames_;  // of each pose
  std::vector<Map> maps_;                    // T per pose block
  std::vector<Map> projected_maps_;          // T P
  std::vector<Chunk> chunks_;
};

}  // namespace glissade
