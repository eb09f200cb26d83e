// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The edges of a group in runs: who is in which, and in which lane.

#include <algorithm>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/structure/structure.h"

namespace glissade {

namespace {

using internal::Index;

constexpr std::int32_t kLaneBlock = LandmarkPlan::kLaneBlock;
/// So many empty lanes in a row end a run, and an edge looks for its run among so many: sensors of
/// all kinds shall cost neither lanes nor time without bound.
constexpr std::int32_t kMaxGap = 32;
constexpr int kMaxLookedAt = 16;

std::int32_t RoundUp(std::int32_t lanes) {
  return (lanes + kLaneBlock - 1) / kLaneBlock * kLaneBlock;
}

}  // namespace

// Landmarks [begin, end) of grouped_ are the group's.
void Structure::PlanGroup(const Graph& graph, LandmarkGroup* group, std::size_t begin,
                          std::size_t end) {
  group->lane_begin = static_cast<std::int32_t>(plan_.landmark_of_lane.size());
  group->used = static_cast<std::int32_t>(end - begin);
  group->lanes = RoundUp(group->used);
  group->step_begin = plan_.step_size;
  plan_.step_size += group->dim * group->lanes;
  group->pair_begin = static_cast<std::int32_t>(plan_.pairs.size());
  group->run_begin = static_cast<std::int32_t>(plan_.runs.size());
  newest_run_.assign(1, -1);  // of the landmarks alone, then of each pair of the group
  next_run_.clear();
  first_edge_.clear();
  run_of_edge_.clear();
  for (std::size_t k = begin; k < end; ++k) {
    plan_.landmark_of_lane.push_back(landmarks_[Index(grouped_[k].landmark)].index);
    const auto lane = static_cast<std::int32_t>(k - begin);
    const auto l = Index(grouped_[k].landmark);
    for (std::int32_t e = landmark_edges_begin_[l]; e < landmark_edges_begin_[l + 1]; ++e)
      run_of_edge_.push_back(FindRun(graph, *group, e, lane));
  }
  plan_.landmark_of_lane.resize(Index(group->lane_begin + group->lanes), -1);
  group->pair_end = static_cast<std::int32_t>(plan_.pairs.size());
  group->run_end = static_cast<std::int32_t>(plan_.runs.size());
  LayOutGroup(group);
  const std::int32_t* run = run_of_edge_.data();
  for (std::size_t k = begin; k < end; ++k) {
    ForEachEdgeOf(grouped_[k].landmark, [&](const EdgeRef& ref) {
      const LandmarkRun& of = plan_.runs[Index(*run++)];
      const std::size_t slot = Index(of.begin - of.first) + (k - begin);
      plan_.edge_of_slot[slot] = ref.edge;
      plan_.landmark_of_slot[slot] = plan_.landmark_of_lane[Index(group->lane_begin) + k - begin];
      plan_.mask_of_slot[slot] = 1.0;
    });
  }
  for (std::int32_t r = group->run_begin; r < group->run_end; ++r)
    FillHoles(plan_.runs[Index(r)]);
  for (std::int32_t p = group->pair_begin; p < group->pair_end; ++p)
    pair_of_pose_[Index(plan_.pairs[Index(p)].target.pose)] = -1;
}

// The run that an edge of the landmark in a lane belongs to; new ones are added.
std::int32_t Structure::FindRun(const Graph& graph, const LandmarkGroup& group,
                                std::int32_t landmark_edge, std::int32_t lane) {
  const EdgeRef ref = landmark_edges_[Index(landmark_edge)];
  const std::int32_t pose = observer_[Index(landmark_edge)];
  std::int32_t pair = -1;
  if (pose >= 0) {
    if (pair_of_pose_[Index(pose)] < 0) {
      pair_of_pose_[Index(pose)] = static_cast<std::int32_t>(plan_.pairs.size());
      const auto poses = Index(graph.Pool<VertexPose>()->id());
      LandmarkPair added;
      added.target = {pose, std::max(variable_[poses][Index(pose)], -1)};
      plan_.pairs.push_back(added);
      newest_run_.push_back(-1);
    }
    pair = pair_of_pose_[Index(pose)];
    plan_.pairs[Index(pair)].used = lane + 1;
  }
  std::int32_t& newest = newest_run_[Index(pair < 0 ? 0 : pair - group.pair_begin + 1)];
  const EdgePoolBase& pool = *graph.edge_pools()[Index(ref.pool)];
  int looked_at = 0;
  for (std::int32_t r = newest; r >= 0 && looked_at < kMaxLookedAt;
       r = next_run_[Index(r - group.run_begin)], ++looked_at) {
    LandmarkRun& run = plan_.runs[Index(r)];
    // A lane has one edge in a run: duplicates that were allowed are runs of their own.
    if (run.pool == ref.pool && run.used <= lane && lane - run.used < kMaxGap &&
        pool.SameInRun(first_edge_[Index(r - group.run_begin)], ref.edge)) {
      run.used = lane + 1;
      return r;
    }
  }
  const auto added = static_cast<std::int32_t>(plan_.runs.size());
  LandmarkRun run;
  run.pool = ref.pool;
  run.pair = pair;
  run.first = lane / kLaneBlock * kLaneBlock;
  run.used = lane + 1;
  plan_.runs.push_back(run);
  first_edge_.push_back(ref.edge);
  next_run_.push_back(newest);
  newest = added;
  return added;
}

// Sorts the targets by falling number of lanes, and gives runs and pairs room.
void Structure::LayOutGroup(LandmarkGroup* group) {
  const auto begin = plan_.pairs.begin() + group->pair_begin;
  std::sort(begin, plan_.pairs.end(), [](const LandmarkPair& a, const LandmarkPair& b) {
    return a.used != b.used ? a.used > b.used : a.target.pose < b.target.pose;
  });
  // Where each pair was is where its pose still says.
  moved_pair_.resize(Index(group->pair_end - group->pair_begin));
  for (std::int32_t p = group->pair_begin; p < group->pair_end; ++p) {
    LandmarkPair& pair = plan_.pairs[Index(p)];
    moved_pair_[Index(pair_of_pose_[Index(pair.target.pose)] - group->pair_begin)] = p;
    pair.lanes = RoundUp(pair.used);
    pair.begin = plan_.pair_lanes;
    plan_.pair_lanes += pair.lanes;
  }
  for (std::int32_t r = group->run_begin; r < group->run_end; ++r) {
    LandmarkRun& run = plan_.runs[Index(r)];
    if (run.pair >= 0) run.pair = moved_pair_[Index(run.pair - group->pair_begin)];
    run.lanes = RoundUp(run.used - run.first);
    run.begin = static_cast<std::int32_t>(plan_.edge_of_slot.size());
    const std::size_t size = plan_.edge_of_slot.size() + Index(run.lanes);
    plan_.edge_of_slot.resize(size, -1);
    plan_.landmark_of_slot.resize(size, -1);
    plan_.mask_of_slot.resize(size, 0.0);
  }
}

// Lanes without an edge repeat the one before them, the first ones the first that is there.
void Structure::FillHoles(const LandmarkRun& run) {
  std::int32_t* const edge = plan_.edge_of_slot.data() + run.begin;
  std::int32_t* const landmark = plan_.landmark_of_slot.data() + run.begin;
  std::int32_t from = 0;
  while (edge[from] < 0)
    ++from;
  for (std::int32_t lane = 0; lane < run.lanes; ++lane) {
    if (edge[lane] >= 0 && lane > from) from = lane;
    edge[lane] = edge[from];
    landmark[lane] = landmark[from];
  }
}

}  // namespace glissade
