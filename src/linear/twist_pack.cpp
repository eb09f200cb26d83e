// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What TwistTerms keeps of runs from one analysis to the next: weights, measurements, room.

#include <algorithm>

#include "linear/twist_terms.h"

#include "glissade/base/index.h"

namespace glissade {

namespace {

using internal::Index;

/// Values of so many edges stay in the first-level cache while they are used.
constexpr std::int32_t kMaxSegment = 64;

}  // namespace

void TwistTerms::Pack(const Structure& structure, const Graph& graph) {
  if (analysis_ == structure.analysis() && weights_version_ == graph.weights_version()) return;
  analysis_ = structure.analysis();
  weights_version_ = graph.weights_version();
  const LandmarkPlan& plan = structure.groups();
  chunks_.resize(std::max(chunks_.size(), Index(structure.num_chunks())));
  maps_.assign(structure.poses().size(), {});
  projected_maps_.resize(structure.poses().size());
  segments_.clear();
  segment_begin_.assign(1, 0);
  weights_.Clear();
  uv_.clear();
  cameras_.clear();
  newest_camera_.clear();
  groups_.clear();
  targets_.clear();
  max_values_ = max_work_ = max_rows_ = 0;
  h_begin_.clear();
  std::int32_t h_size = 0;
  for (const LandmarkGroup& group : plan.groups) {
    h_begin_.push_back(h_size);
    h_size += group.dim * (group.dim + 1) / 2 * group.lanes;
  }
  for (auto* array : {&h_, &factor_})
    array->assign(Index(h_size), 0.0);
  for (auto* array : {&b_, &beta_, &state_, &point_})
    array->assign(Index(plan.step_size), 0.0);
  force_.assign(6 * Index(plan.pair_lanes), 0.0);
  has_run_.assign(plan.pairs.size(), 0);
  force_is_set_.assign(plan.pairs.size(), 0);
  std::size_t max_pairs = 0, max_pull = 0;
  for (const LandmarkPair& pair : plan.pairs)
    targets_.push_back({pair.used, pair.lanes, force_.data() + 6 * std::int64_t{pair.begin}});
  for (const LandmarkGroup& group : plan.groups) {
    const std::int32_t pairs = group.pair_end - group.pair_begin;
    max_pairs = std::max(max_pairs, Index(pairs));
    groups_.push_back({group.dim, group.used, group.lanes, pairs,
                       targets_.data() + group.pair_begin, point_.data() + group.step_begin});
    std::size_t pull = 0;
    for (std::int32_t p = group.pair_begin; p < group.pair_end && group.dim > 1; ++p)
      pull += 3 * Index(plan.pairs[Index(p)].lanes);
    max_pull = std::max(max_pull, pull);
    for (std::int32_t r = group.run_begin; r < group.run_end; ++r)
      PackRun(plan, graph, group, r);
    segment_begin_.push_back(static_cast<std::int32_t>(segments_.size()));
  }
  if (plan.empty()) return;
  PlanBlocks(structure);
  for (Chunk& chunk : chunks_) {
    chunk.values.resize(std::max(chunk.values.size(), max_values_));
    chunk.work.resize(std::max(chunk.work.size(), max_work_));
    chunk.states.resize(kMaxSegment);
    chunk.points.assign(kMaxSegment, nullptr);
    chunk.weights.Resize(kMaxSegment, max_rows_);
    if (chunk.redone.size() < graph.edge_pools().size())
      chunk.redone.resize(graph.edge_pools().size(), 0);
    chunk.pairs.resize(std::max(chunk.pairs.size(), max_pairs));
    chunk.pull.resize(std::max(chunk.pull.size(), max_pull));
  }
}

void TwistTerms::PackRun(const LandmarkPlan& plan, const Graph& graph, const LandmarkGroup& group,
                         std::int32_t index) {
  const LandmarkRun& run = plan.runs[Index(index)];
  const EdgePoolBase& pool = *graph.edge_pools()[Index(run.pool)];
  const int rows = pool.residual_dim(0);
  const bool sets_force = run.pair >= 0 && !has_run_[Index(run.pair)] && run.first == 0 &&
                          run.lanes == plan.pairs[Index(run.pair)].lanes;
  if (run.pair >= 0) has_run_[Index(run.pair)] = 1;
  if (sets_force) force_is_set_[Index(run.pair)] = 1;
  for (std::int32_t first = 0; first < run.lanes; first += kMaxSegment) {
    Segment segment;
    segment.run = index;
    segment.first = first;
    segment.lane = run.first + first;
    segment.sets_force = sets_force;
    segment.lanes = std::min(kMaxSegment, run.lanes - first);
    // Padding costs nothing in packs; and a run is then a whole number of them.
    segment.count = pool.evaluates_in_packs() ? segment.lanes
                                              : std::min(segment.lanes, run.used - segment.lane);
    const double* mask = plan.mask_of_slot.data() + run.begin + first;
    segment.masked = std::find(mask, mask + segment.count, 0.0) != mask + segment.count;
    segment.weights = weights_.Add(pool, plan.edge_of_slot.data() + run.begin + first, rows,
                                   segment.count, segment.lanes);
    PackTwoViews(plan, pool, group, &segment);
    segments_.push_back(segment);
  }
  max_rows_ = std::max(max_rows_, Index(rows));
  max_values_ = std::max(max_values_, Index(rows * kColumns) * Index(kMaxSegment));
  // One edge's residual and all of its Jacobians.
  max_work_ = std::max(max_work_, Index(rows * (kColumns + 6)));
}

// A chunk's groups fill few of the blocks: it clears those alone, and only their sums are added up.
void TwistTerms::PlanBlocks(const Structure& structure) {
  const LandmarkPlan& plan = structure.groups();
  const int num_chunks = structure.num_chunks();
  chunk_map_ = plan.block_map;
  blocks_of_chunk_.assign(Index(num_chunks), 0);
  auto& [newest, index, plan_block, next] = plan_scratch_;
  newest.assign(plan.blocks.size(), -1);
  index.assign(plan.blocks.size(), 0);
  plan_block.clear();
  chunk_blocks_begin_.assign(plan.blocks.size() + 1, 0);
  for (int chunk = 0; chunk < num_chunks; ++chunk) {
    const auto map_begin = [&](std::int32_t group) {
      return Index(group) < plan.groups.size() ? Index(plan.groups[Index(group)].map_begin)
                                               : plan.block_map.size();
    };
    const std::size_t end = map_begin(plan.chunk_begin[Index(chunk) + 1]);
    for (std::size_t k = map_begin(plan.chunk_begin[Index(chunk)]); k < end; ++k) {
      const std::int32_t entry = plan.block_map[k];
      if (entry == LandmarkPlan::kNoBlock) continue;
      const std::size_t block = Index(entry >= 0 ? entry : ~entry);
      if (newest[block] != chunk) {
        newest[block] = chunk;
        index[block] = blocks_of_chunk_[Index(chunk)]++;
        plan_block.push_back(static_cast<std::int32_t>(block));
        ++chunk_blocks_begin_[block + 1];
      }
      chunk_map_[k] = entry >= 0 ? index[block] : ~index[block];
    }
  }
  for (std::size_t b = 0; b < plan.blocks.size(); ++b)
    chunk_blocks_begin_[b + 1] += chunk_blocks_begin_[b];
  chunk_blocks_.resize(plan_block.size());
  next.assign(chunk_blocks_begin_.begin(), chunk_blocks_begin_.end() - 1);
  std::size_t k = 0;
  for (int chunk = 0; chunk < num_chunks; ++chunk) {
    for (std::int32_t i = 0; i < blocks_of_chunk_[Index(chunk)]; ++i, ++k)
      chunk_blocks_[Index(next[Index(plan_block[k])]++)] = {chunk, i};
  }
}

std::int64_t TwistTerms::Edges(const Structure& structure, int pool) const {
  const LandmarkPlan& plan = structure.groups();
  std::int64_t edges = 0;
  for (const LandmarkRun& run : plan.runs) {
    if (run.pool != pool) continue;
    const double* mask = plan.mask_of_slot.data() + run.begin;
    edges += std::count(mask, mask + run.lanes, 1.0);
  }
  return edges;
}

std::int64_t TwistTerms::Lanes(const Structure& structure, int pool) const {
  std::int64_t lanes = 0;
  for (const LandmarkRun& run : structure.groups().runs)
    lanes += run.pool == pool ? run.lanes : 0;
  return lanes;
}

std::int64_t TwistTerms::Redone(int pool) const {
  std::int64_t redone = 0;
  for (const Chunk& chunk : chunks_)
    redone += Index(pool) < chunk.redone.size() ? chunk.redone[Index(pool)] : 0;
  return redone;
}

void TwistTerms::ForgetRedone() {
  for (Chunk& chunk : chunks_)
    chunk.redone.assign(chunk.redone.size(), 0);
}

}  // namespace glissade
