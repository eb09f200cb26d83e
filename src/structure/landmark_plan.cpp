// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/structure/landmark_plan.h"

#include <algorithm>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/structure/structure.h"

namespace glissade {

namespace {

using internal::Index;

}  // namespace

// What edges of each type say of their landmark: that it may be in a group, or not.
void Structure::ClassifyPools(const Graph& graph) {
  const VertexPoolBase* poses = graph.PoolOf(&kTypeInfo<VertexPose>);
  const VertexPoolBase* depths = graph.PoolOf(&kTypeInfo<VertexInverseDepth>);
  const VertexPoolBase* points = graph.PoolOf(&kTypeInfo<VertexPointXYZ>);
  pool_kind_.assign(num_pools_, PoolKind::kOther);
  for (std::size_t p = 0; p < num_pools_; ++p) {
    const EdgePoolBase& pool = *graph.edge_pools()[p];
    const int arity = pool.fixed_arity();
    // Edges that take both vertices of the relative pose or point as their rule says.
    const auto knows = [&](FirstEstimateRule rule) {
      return pool.traits().first_estimate_rule == rule &&
             (pool.traits().no_first_estimate & 3u) == 0;
    };
    const auto is = [&](int vertex, const VertexPoolBase* of) {
      return of != nullptr && pool.vertex_pool(0, vertex) == of;
    };
    if (pool.size() == 0) continue;
    if (arity == 1 && (is(0, depths) || is(0, points))) {
      pool_kind_[p] = PoolKind::kLandmarkOnly;
    } else if (arity == 3 && is(0, poses) && is(1, poses) && is(2, depths) &&
               knows(FirstEstimateRule::kRelativePose)) {
      pool_kind_[p] = PoolKind::kHostAndTarget;
    } else if (arity == 2 && is(0, poses) && is(1, points) &&
               knows(FirstEstimateRule::kRelativePoint)) {
      pool_kind_[p] = PoolKind::kPoseAndPoint;
    }
  }
}

// Once for all: the passes below walk over the edges of landmarks again and again.
void Structure::ListObservers() {
  const std::int32_t count = landmark_edges_begin_[landmarks_.size()];
  observer_.resize(Index(count));
  for (std::size_t k = 0; k < observer_.size(); ++k) {
    const EdgeRef ref = landmark_edges_[k];
    const std::int32_t* const index = flat_[Index(ref.pool)].index.data();
    switch (pool_kind_[Index(ref.pool)]) {
      case PoolKind::kHostAndTarget:
        observer_[k] = index[3 * Index(ref.edge) + 1];
        break;
      case PoolKind::kPoseAndPoint:
        observer_[k] = index[2 * Index(ref.edge)];
        break;
      case PoolKind::kLandmarkOnly:
        observer_[k] = kNoObserver;
        break;
      case PoolKind::kOther:
        observer_[k] = kNoGroup;
        break;
    }
  }
}

// The host of all edges of an inverse depth, the first pose that sees a point; -1 if there is none
// or the landmark may not be in a group.
std::int32_t Structure::HostOf(std::size_t landmark) const {
  std::int32_t host = -1;
  for (std::int32_t k = landmark_edges_begin_[landmark]; k < landmark_edges_begin_[landmark + 1];
       ++k) {
    const std::int32_t observer = observer_[Index(k)];
    if (observer == kNoObserver) continue;
    if (observer == kNoGroup) return -1;
    const EdgeRef ref = landmark_edges_[Index(k)];
    if (pool_kind_[Index(ref.pool)] == PoolKind::kPoseAndPoint) {
      host = host < 0 ? observer : std::min(host, observer);
      continue;
    }
    const std::int32_t of_edge = flat_[Index(ref.pool)].index[3 * Index(ref.edge)];
    if (host >= 0 && of_edge != host) return -1;
    host = of_edge;
    if (observer == host) return -1;
  }
  return host;
}

// Finds the landmarks that qualify by what their edges are like, whatever the states.
void Structure::FindGroups(const Graph& graph) {
  grouped_.clear();
  ClassifyPools(graph);
  ListObservers();
  AddGroups(graph, PoolKind::kHostAndTarget, &kTypeInfo<VertexInverseDepth>);
  AddGroups(graph, PoolKind::kPoseAndPoint, &kTypeInfo<VertexPointXYZ>);
  // By group, then falling number of edges or last pose; the landmark's number settles ties.
  std::sort(grouped_.begin(), grouped_.end(),
            [](const GroupedLandmark& a, const GroupedLandmark& b) {
              if (a.group != b.group) return a.group < b.group;
              return a.length != b.length ? a.length > b.length : a.landmark < b.landmark;
            });
}

// Groups of one type of landmark, which edges of one kind observe.
void Structure::AddGroups(const Graph& graph, PoolKind kind, const TypeInfo* type) {
  if (std::find(pool_kind_.begin(), pool_kind_.end(), kind) == pool_kind_.end()) return;
  const VertexPoolBase& pool = *graph.PoolOf(type);
  const std::vector<std::int32_t>& block_of_pose = variable_[Index(graph.Pool<VertexPose>()->id())];
  group_of_host_.assign(block_of_pose.size(), -1);
  auto& groups = plan_.groups;
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    if (landmarks_[l].pool != pool.id()) continue;
    const std::int32_t host = HostOf(l);
    if (host < 0) continue;
    std::int32_t& group = group_of_host_[Index(host)];
    if (group < 0) {
      group = static_cast<std::int32_t>(groups.size());
      LandmarkGroup added;
      added.host = {host, std::max(block_of_pose[Index(host)], -1)};
      added.pool = pool.id();
      added.dim = pool.ops().tangent_dim;
      groups.push_back(added);
    }
    const auto landmark = static_cast<std::int32_t>(l);
    grouped_.push_back({group, TrackLength(kind, landmark), landmark});
  }
}

// What lanes of a group are sorted by: number of edges, or the last pose that sees a point.
std::int32_t Structure::TrackLength(PoolKind kind, std::int32_t landmark) const {
  const std::size_t l = Index(landmark);
  if (kind == PoolKind::kHostAndTarget)
    return landmark_edges_begin_[l + 1] - landmark_edges_begin_[l];
  std::int32_t last = 0;
  ForEachObserverOf(landmark, [&](std::int32_t pose) { last = std::max(last, pose); });
  return last;
}

void Structure::PlanGroups(const Graph& graph, bool allow) {
  plan_.Clear();
  if (!allow) return;
  FindGroups(graph);
  if (grouped_.empty()) return;
  ChooseCenter(graph);
  LeaveOutFarLandmarks(graph);
  LeaveOutSparseGroups(graph);
  if (grouped_.empty()) return;
  plan_.num_landmarks = static_cast<int>(grouped_.size());
  pair_of_pose_.assign(Index(graph.Pool<VertexPose>()->size()), -1);
  std::size_t next = 0;
  for (std::size_t g = 0; g < plan_.groups.size(); ++g) {
    const std::size_t begin = next;
    while (next < grouped_.size() && grouped_[next].group == static_cast<std::int32_t>(g))
      ++next;
    PlanGroup(graph, &plan_.groups[g], begin, next);
  }
  plan_.reach = Reach(graph);
  RemoveGroupedFromLandmarks();
}

void Structure::RemoveGroupedFromLandmarks() {
  is_grouped_.assign(landmarks_.size(), 0);
  for (const GroupedLandmark& grouped : grouped_)
    is_grouped_[Index(grouped.landmark)] = 1;
  const std::size_t count = landmarks_.size();
  std::size_t kept = 0;
  std::int32_t to = 0;
  num_landmark_scalars_ = 0;
  const auto keep = [&](std::size_t bucket) {
    const std::int32_t begin = landmark_edges_begin_[bucket],
                       end = landmark_edges_begin_[bucket + 1];
    for (std::int32_t k = begin; k < end; ++k)
      landmark_edges_[Index(to + k - begin)] = landmark_edges_[Index(k)];
    return end - begin;
  };
  for (std::size_t l = 0; l < count; ++l) {
    if (is_grouped_[l] != 0) continue;
    const std::int32_t edges = keep(l);
    landmarks_[kept] = landmarks_[l];
    landmarks_[kept].step = num_landmark_scalars_;
    num_landmark_scalars_ += landmarks_[l].dim;
    landmark_edges_begin_[kept++] = to;
    to += edges;
  }
  const std::int32_t without = keep(count);
  landmark_edges_begin_[kept] = to;
  landmark_edges_begin_[kept + 1] = to + without;
  landmark_edges_begin_.resize(kept + 2);
  landmark_edges_.resize(Index(to + without));
  landmarks_.resize(kept);
  plan_.first_step = num_landmark_scalars_;
  num_landmark_scalars_ += plan_.step_size;
}

// What the groups contribute to H_pp and S, and who computes them: needs the pose blocks' pairs.
void Structure::FinishPlan() {
  chain_of_row_.assign(poses_.size(), -1);
  next_in_row_.clear();
  for (LandmarkGroup& group : plan_.groups) {
    frames_.clear();
    for (int frame = 0; frame < group.num_frames(); ++frame)
      frames_.push_back(plan_.FrameBlock(group, frame));
    for (std::int32_t p = group.pair_begin; p < group.pair_end; ++p) {
      LandmarkPair& pair = plan_.pairs[Index(p)];
      if (group.num_hosts() == 0 || group.host.block < 0 || pair.target.block < 0) continue;
      pair.h_transposed = group.host.block < pair.target.block;
      pair.h_block = pair.h_transposed ? PairOffset(pair.target.block, group.host.block)
                                       : PairOffset(group.host.block, pair.target.block);
    }
    group.map_begin = static_cast<std::int32_t>(plan_.block_map.size());
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const std::int32_t a = frames_[i], b = frames_[j];
        if (a < 0 || b < 0) {
          plan_.block_map.push_back(LandmarkPlan::kNoBlock);
        } else {
          const std::int32_t block = PlanBlock(std::max(a, b), std::min(a, b));
          plan_.block_map.push_back(a >= b ? block : ~block);
        }
      }
    }
  }
  // Chunks: groups shared out evenly by their edges.
  plan_.chunk_begin.assign(1, 0);
  const auto total = static_cast<std::int64_t>(plan_.edge_of_slot.size());
  std::int64_t done = 0;
  std::size_t g = 0;
  for (int c = 1; c <= num_chunks_; ++c) {
    while (g < plan_.groups.size() && done < total * c / num_chunks_) {
      for (std::int32_t r = plan_.groups[g].run_begin; r < plan_.groups[g].run_end; ++r)
        done += plan_.runs[Index(r)].lanes;
      ++g;
    }
    plan_.chunk_begin.push_back(c == num_chunks_ ? static_cast<std::int32_t>(plan_.groups.size())
                                                 : static_cast<std::int32_t>(g));
  }
}

std::int32_t Structure::PlanBlock(std::int32_t row, std::int32_t col) {
  // Blocks of one row are chained: a row has as many as there are frames it shares landmarks with.
  for (std::int32_t k = chain_of_row_[Index(row)]; k >= 0; k = next_in_row_[Index(k)]) {
    if (plan_.blocks[Index(k)].col == col) return k;
  }
  const auto added = static_cast<std::int32_t>(plan_.blocks.size());
  plan_.blocks.push_back({row, col});
  next_in_row_.push_back(chain_of_row_[Index(row)]);
  chain_of_row_[Index(row)] = added;
  return added;
}

}  // namespace glissade
