// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/twist_terms.h"

#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/vertices/pose.h"

namespace glissade {

using internal::Index;

TwistTerms::Values TwistTerms::Place(const Segment& segment, int landmark, int target,
                                     Chunk* chunk) {
  Values values;
  const std::int64_t size = std::int64_t{segment.weights.rows} * segment.lanes;
  values.r = chunk->values.data();
  if (landmark > 0) values.J_l = values.r + size;
  if (target > 0) values.J = values.J_l + landmark * size;
  values.count = (1 + landmark + target) * size;
  return values;
}

int TwistTerms::Evaluate(const LandmarkPlan& plan, const Graph& graph, const LandmarkGroup& group,
                         const Segment& segment, const Values& values, Chunk* chunk, double* cost,
                         LaneWeights::Factors* factors) const {
  const int failed = EvaluateRaw(plan, graph, group, segment, values, chunk);
  if (failed >= 0) return failed;
  const LandmarkRun& run = plan.runs[Index(segment.run)];
  const std::int32_t slot = run.begin + segment.first;
  const LaneMatrix J[2] = {{values.J_l, group.dim}, {values.J, 6}};
  const std::size_t matrices = values.J_l == nullptr ? 0 : (values.J == nullptr ? 1 : 2);
  return weights_.Weigh(segment.weights, *graph.edge_pools()[Index(run.pool)],
                        plan.edge_of_slot.data() + slot,
                        segment.masked ? plan.mask_of_slot.data() + slot : nullptr, values.r,
                        {J, matrices}, &chunk->weights, cost, factors);
}

int TwistTerms::EvaluateRaw(const LandmarkPlan& plan, const Graph& graph,
                            const LandmarkGroup& group, const Segment& segment,
                            const Values& values, Chunk* chunk) const {
  if (segment.host_camera >= 0) {
    const kernels::TwoViewRun lanes = TwoViewsOf(plan, group, segment);
    const kernels::TwoViewValues out{values.r, values.J_l, values.J};
    kernels::Kernels().two_view_lanes(&lanes, &out);
    return -1;
  }
  const LandmarkRun& run = plan.runs[Index(segment.run)];
  const EdgePoolBase& pool = *graph.edge_pools()[Index(run.pool)];
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  const VertexPoolBase& landmarks = *graph.vertex_pools()[Index(group.pool)];
  const std::int32_t* landmark = plan.landmark_of_slot.data() + run.begin + segment.first;
  for (std::int32_t s = 0; s < segment.count; ++s)
    chunk->states[Index(s)] = landmarks.Data(landmark[s]);
  const double* const none[3] = {nullptr, nullptr, nullptr};
  const double* states[3] = {nullptr, nullptr, nullptr};
  double* J[3] = {nullptr, nullptr, nullptr};
  // [host, target, landmark] with what there is of them.
  int vertex = 0;
  if (run.pair >= 0) {
    if (group.num_hosts() > 0) states[vertex++] = poses.Data(group.host.pose);
    J[vertex] = values.J;
    states[vertex++] = poses.Data(plan.pairs[Index(run.pair)].target.pose);
  }
  J[vertex] = values.J_l;
  LaneRun lanes;
  lanes.count = segment.count;
  lanes.lanes = segment.lanes;
  lanes.edges = plan.edge_of_slot.data() + run.begin + segment.first;
  lanes.landmark = vertex;
  lanes.states = states;
  lanes.points = none;
  lanes.landmark_states = chunk->states.data();
  lanes.landmark_points = chunk->points.data();
  lanes.work = chunk->work.data();
  const int failed = pool.EvaluateRun(
      lanes,
      {values.r, values.J_l != nullptr ? J : nullptr, chunk->redone.data() + Index(run.pool)},
      FirstEstimates::kOff);
  if (failed >= 0 || segment.count == segment.lanes) return failed;
  for (std::int64_t k = 0; k < values.count; k += segment.lanes)
    std::fill(values.r + k + segment.count, values.r + k + segment.lanes, 0.0);
  return -1;
}

int TwistTerms::AddValues(const LandmarkPlan& plan, const Graph& graph, const LandmarkGroup& group,
                          const Segment& segment, const kernels::TwistTotals& totals, Chunk* chunk,
                          double* cost) const {
  const kernels::KernelTable& kernel = kernels::Kernels();
  if (segment.in_one) {
    const kernels::TwoViewRun lanes = TwoViewsOf(plan, group, segment);
    const kernels::TwoViewWeights weights = TwoViewWeightsOf(segment);
    double added = 0.0;
    if (kernel.two_view_sums(&lanes, &weights, &totals, &added) != 0) {
      *cost += added;
      return -1;
    }
    // Once more with the values written down, to find whose it is.
  }
  const bool has_target = plan.runs[Index(segment.run)].pair >= 0;
  const Values values = Place(segment, 1, has_target ? 6 : 0, chunk);
  LaneWeights::Factors factors;
  const int failed = Evaluate(plan, graph, group, segment, values, chunk, cost, &factors);
  if (failed >= 0) return failed;
  const kernels::TwistRun run{segment.weights.rows, segment.lanes, values.r, values.J_l, values.J,
                              factors.scale,        factors.weight};
  // What is not finite in the values is not in the sums.
  if (!segment.in_one && kernel.twist_sums(&run, &totals) != 0) return -1;
  return FindNotFiniteLane(segment.lanes, values.count, values.r);
}

bool TwistTerms::LinearizeGroup(const LandmarkPlan& plan, const Graph& graph, int index,
                                NormalEquationsSink* sink, Chunk* chunk, std::int32_t* pool) {
  const LandmarkGroup& group = plan.groups[Index(index)];
  FillStates(plan, graph, group);
  double* const h = h_.data() + h_begin_[Index(index)];
  double* const b = b_.data() + group.step_begin;
  std::fill_n(h, group.lanes, 0.0);
  std::fill_n(b, group.lanes, 0.0);
  for (std::int32_t p = group.pair_begin; p < group.pair_end; ++p) {
    const LandmarkPair& pair = plan.pairs[Index(p)];
    if (!force_is_set_[Index(p)])
      std::fill_n(force_.begin() + 6 * std::int64_t{pair.begin}, 6 * pair.lanes, 0.0);
    chunk->pairs[Index(p - group.pair_begin)] = {};
  }
  for (std::int32_t k = segment_begin_[Index(index)]; k < segment_begin_[Index(index) + 1]; ++k) {
    const Segment& segment = segments_[Index(k)];
    const LandmarkRun& run = plan.runs[Index(segment.run)];
    kernels::TwistTotals totals{};
    totals.h = h + segment.lane;
    totals.b = b + segment.lane;
    if (run.pair >= 0) {
      const LandmarkPair& pair = plan.pairs[Index(run.pair)];
      totals.frame = &FrameOf(segment, pair.target.pose);
      totals.force = force_.data() + 6 * std::int64_t{pair.begin} + segment.lane;
      totals.force_lanes = pair.lanes;
      totals.sets_force = segment.sets_force;
      totals.sums = chunk->pairs[Index(run.pair - group.pair_begin)].x;
    }
    const int failed = AddValues(plan, graph, group, segment, totals, chunk, &sink->cost);
    if (failed >= 0) return Fail(plan, segment, failed, sink, pool);
  }
  return true;
}

bool TwistTerms::Fail(const LandmarkPlan& plan, const Segment& segment, int lane,
                      NormalEquationsSink* sink, std::int32_t* pool) {
  const LandmarkRun& run = plan.runs[Index(segment.run)];
  *pool = run.pool;
  sink->failed_edge = plan.edge_of_slot[Index(run.begin + segment.first + lane)];
  return false;
}

// Sums of pairs: those of two frames go to H_pp, those of one to the frames'.
void TwistTerms::AddGroup(const Structure& structure, int index, double* h_pp, Chunk* chunk) {
  const LandmarkPlan& plan = structure.groups();
  const LandmarkGroup& group = plan.groups[Index(index)];
  const std::int32_t h = group.host.block;
  TwistSum at_host;
  for (std::int32_t p = group.pair_begin; p < group.pair_end; ++p) {
    const LandmarkPair& pair = plan.pairs[Index(p)];
    const TwistSum& sum = chunk->pairs[Index(p - group.pair_begin)];
    at_host.Add(sum, -1.0);
    const std::int32_t t = pair.target.block;
    if (t < 0) continue;
    chunk->frames[Index(t)].Add(sum, 1.0);
    if (pair.h_block < 0) continue;
    const std::int32_t row = pair.h_transposed ? t : h, col = pair.h_transposed ? h : t;
    double H[36];
    sum.Unpack(H);
    kernels::Kernels().map_block(-1.0, maps_[Index(row)].T, H, 6, maps_[Index(col)].T,
                                 h_pp + pair.h_block, 6);
  }
  if (h >= 0) chunk->frames[Index(h)].Add(at_host, 1.0);
}

void TwistTerms::AddFrames(const Structure& structure, const Chunk& chunk, double* h_pp,
                           double* b_p) const {
  for (std::size_t k = 0; k < chunk.frames.size(); ++k) {
    const TwistSum& frame = chunk.frames[k];
    if (!frame.used) continue;
    const double* T = maps_[k].T;
    const PoseBlock& pose = structure.poses()[k];
    double H[36];
    frame.Unpack(H);
    kernels::Kernels().map_block(1.0, T, H, 6, T, h_pp + pose.h_diagonal, 6);
    // b = -J'r in the tangent: T' of the twist's.
    for (int c = 0; c < 6; ++c) {
      double sum = 0.0;
      for (int i = 0; i < 6; ++i)
        sum += T[8 * i + c] * frame.x[TwistSum::kGradient + i];
      b_p[pose.offset + c] += sum;
    }
  }
}

bool TwistTerms::Linearize(const Structure& structure, const Graph& graph, int index,
                           NormalEquationsSink* sink, std::int32_t* pool) {
  const LandmarkPlan& plan = structure.groups();
  if (plan.empty()) return true;
  Chunk* chunk = &chunks_[Index(index)];
  // Diagonal blocks and right-hand sides are summed as twists and mapped once per frame.
  chunk->frames.assign(structure.poses().size(), {});
  for (int g = plan.chunk_begin[Index(index)]; g < plan.chunk_begin[Index(index) + 1]; ++g) {
    if (plan.groups[Index(g)].dim > 1) {
      if (!LinearizePoints(plan, graph, g, sink, chunk, pool)) return false;
      continue;
    }
    if (!LinearizeGroup(plan, graph, g, sink, chunk, pool)) return false;
    AddGroup(structure, g, sink->h_pp, chunk);
  }
  AddFrames(structure, *chunk, sink->h_pp, sink->b_p);
  return true;
}

bool TwistTerms::Cost(const Structure& structure, const Graph& graph, int index,
                      NormalEquationsSink* sink, std::int32_t* pool) {
  const LandmarkPlan& plan = structure.groups();
  if (plan.empty()) return true;
  Chunk* chunk = &chunks_[Index(index)];
  for (int g = plan.chunk_begin[Index(index)]; g < plan.chunk_begin[Index(index) + 1]; ++g) {
    const LandmarkGroup& group = plan.groups[Index(g)];
    FillStates(plan, graph, group);
    for (std::int32_t k = segment_begin_[Index(g)]; k < segment_begin_[Index(g) + 1]; ++k) {
      const Segment& segment = segments_[Index(k)];
      if (segment.in_one) {
        const double added = CostInOne(plan, group, segment);
        if (std::isfinite(added)) {
          sink->cost += added;
          continue;
        }
      }
      const Values values = Place(segment, 0, 0, chunk);
      LaneWeights::Factors factors;
      const int failed =
          Evaluate(plan, graph, group, segment, values, chunk, &sink->cost, &factors);
      if (failed >= 0) return Fail(plan, segment, failed, sink, pool);
    }
  }
  return true;
}

}  // namespace glissade
