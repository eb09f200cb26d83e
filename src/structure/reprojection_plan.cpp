// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/structure/reprojection_plan.h"

#include <algorithm>

#include "glissade/edges/reprojection.h"
#include "glissade/losses/huber.h"
#include "glissade/structure/structure.h"

namespace glissade {

namespace {

std::size_t Index(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

constexpr std::int32_t kLaneBlock = ReprojectionPlan::kLaneBlock;

std::int32_t RoundUp(std::int32_t lanes) {
  return (lanes + kLaneBlock - 1) / kLaneBlock * kLaneBlock;
}

}  // namespace

// Finds the landmarks that qualify by what their edges are like, whatever the states: all are
// EdgeReprojection with one host, one extrinsic and one host observation, and no loss but Huber's.
// With first estimates in full, edges on poses that have one take the general path.
void Structure::FindFusedLandmarks(const Graph& graph) {
  fused_.clear();
  const EdgePool<EdgeReprojection>* pool = graph.Pool<EdgeReprojection>();
  if (pool == nullptr) return;
  std::int32_t pool_id = 0;
  while (graph.edge_pools()[Index(pool_id)].get() != pool)
    ++pool_id;
  const FlatEdges& flat = flat_[Index(pool_id)];
  group_of_host_.assign(Index(graph.Pool<VertexPose>()->size()), -1);
  pair_of_pose_.assign(group_of_host_.size(), -1);  // here: the last landmark seen from a pose
  auto& groups = plan_.groups;
  const LinearizationTable& first_estimates = graph.Pool<VertexPose>()->first_estimates();
  const bool full = graph.first_estimates() == FirstEstimates::kFull && !first_estimates.empty();
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    const std::int32_t begin = landmark_edges_begin_[l], end = landmark_edges_begin_[l + 1];
    const EdgeRef* refs = landmark_edges_.data() + begin;
    const std::int32_t count = end - begin;
    const std::int32_t first = refs[0].edge;
    bool fused = true;
    for (std::int32_t k = 0; fused && k < count; ++k) {
      const std::int32_t edge = refs[k].edge;
      fused = refs[k].pool == pool_id &&
              (pool->loss(edge).trivial() || pool->loss(edge).As<Huber>() != nullptr) &&
              flat.index[Index(3 * edge)] == flat.index[Index(3 * first)] &&
              pool->At(edge).SameSensor(pool->At(first)) &&
              pool->At(edge).uv_host == pool->At(first).uv_host;
      if (fused && full) {
        fused = first_estimates.At(flat.index[Index(3 * edge)]) == nullptr &&
                first_estimates.At(flat.index[Index(3 * edge + 1)]) == nullptr;
      }
      if (!fused) break;
      // One lane per landmark and target: an observation that is there twice takes the other path.
      std::int32_t& seen = pair_of_pose_[Index(flat.index[Index(3 * edge + 1)])];
      fused = seen != static_cast<std::int32_t>(l);
      seen = static_cast<std::int32_t>(l);
    }
    if (!fused) continue;
    // Groups of one host are linked, newest first: there is one per camera of the rig.
    const std::int32_t host = flat.index[Index(3 * first)];
    std::int32_t group = group_of_host_[Index(host)];
    while (group >= 0 && !pool->At(first).SameSensor(pool->At(groups[Index(group)].edge))) {
      group = groups[Index(group)].map_begin;  // the link, until FinishReprojectionPlan sets it
    }
    if (group < 0) {
      group = static_cast<std::int32_t>(groups.size());
      ReprojectionGroup added;
      added.host = {host,
                    flat.variable[Index(3 * first)] >= 0 ? flat.variable[Index(3 * first)] : -1};
      added.edge = first;
      added.map_begin = group_of_host_[Index(host)];
      groups.push_back(added);
      group_of_host_[Index(host)] = group;
    }
    fused_.push_back({group, count, static_cast<std::int32_t>(l)});
  }
  // By group, then falling track length; the landmark's number settles ties.
  std::sort(fused_.begin(), fused_.end(), [](const FusedLandmark& a, const FusedLandmark& b) {
    if (a.group != b.group) return a.group < b.group;
    return a.length != b.length ? a.length > b.length : a.landmark < b.landmark;
  });
}

void Structure::PlanReprojections(const Graph& graph, bool allow) {
  plan_.Clear();
  if (!allow) return;
  FindFusedLandmarks(graph);
  if (fused_.empty()) return;
  ChooseCenter(graph);
  LeaveOutFarLandmarks(graph);
  if (fused_.empty()) return;
  plan_.num_landmarks = static_cast<int>(fused_.size());
  std::int32_t pool_id = 0;
  while (graph.edge_pools()[Index(pool_id)]->type() != &kTypeInfo<EdgeReprojection>)
    ++pool_id;
  const FlatEdges& flat = flat_[Index(pool_id)];
  pair_of_pose_.assign(Index(graph.Pool<VertexPose>()->size()), -1);

  std::size_t next = 0;
  for (std::size_t g = 0; g < plan_.groups.size(); ++g) {
    ReprojectionGroup& group = plan_.groups[g];
    const std::size_t begin = next;
    while (next < fused_.size() && fused_[next].group == static_cast<std::int32_t>(g))
      ++next;
    group.lane_begin = static_cast<std::int32_t>(plan_.landmark_of_lane.size());
    group.lanes = RoundUp(static_cast<std::int32_t>(next - begin));
    group.pair_begin = static_cast<std::int32_t>(plan_.pairs.size());
    for (std::size_t k = begin; k < next; ++k) {
      plan_.landmark_of_lane.push_back(landmarks_[Index(fused_[k].landmark)].index);
      // Count the lanes of each target: up to the last landmark it sees.
      ForEachEdgeOf(fused_[k].landmark, [&](std::int32_t edge) {
        const std::int32_t pose = flat.index[Index(3 * edge + 1)];
        std::int32_t& pair = pair_of_pose_[Index(pose)];
        if (pair < 0) {
          pair = static_cast<std::int32_t>(plan_.pairs.size());
          const std::int32_t block = flat.variable[Index(3 * edge + 1)];
          ReprojectionPair added;
          added.target = {pose, block >= 0 ? block : -1};
          plan_.pairs.push_back(added);
        }
        plan_.pairs[Index(pair)].lanes = static_cast<std::int32_t>(k - begin) + 1;
        ++plan_.num_edges;
      });
    }
    plan_.landmark_of_lane.resize(Index(group.lane_begin + group.lanes), -1);
    group.pair_end = static_cast<std::int32_t>(plan_.pairs.size());
    LayOutGroup(&group);
    for (std::size_t k = begin; k < next; ++k) {
      ForEachEdgeOf(fused_[k].landmark, [&](std::int32_t edge) {
        const std::int32_t pair = pair_of_pose_[Index(flat.index[Index(3 * edge + 1)])];
        plan_.edge_of_slot[Index(plan_.pairs[Index(pair)].slots) + (k - begin)] = edge;
      });
    }
    for (std::int32_t p = group.pair_begin; p < group.pair_end; ++p) {
      pair_of_pose_[Index(plan_.pairs[Index(p)].target.pose)] = -1;
    }
  }
  plan_.reach = Reach(graph);
  RemoveFusedFromGeneral();
}

// Sorts the targets by falling number of lanes and gives their observations room.
void Structure::LayOutGroup(ReprojectionGroup* group) {
  const auto begin = plan_.pairs.begin() + group->pair_begin;
  std::sort(begin, plan_.pairs.end(), [](const ReprojectionPair& a, const ReprojectionPair& b) {
    return a.lanes != b.lanes ? a.lanes > b.lanes : a.target.pose < b.target.pose;
  });
  for (std::int32_t p = group->pair_begin; p < group->pair_end; ++p) {
    ReprojectionPair& pair = plan_.pairs[Index(p)];
    pair_of_pose_[Index(pair.target.pose)] = p;
    pair.lanes = RoundUp(pair.lanes);
    pair.slots = static_cast<std::int32_t>(plan_.edge_of_slot.size());
    plan_.edge_of_slot.resize(plan_.edge_of_slot.size() + Index(pair.lanes), -1);
  }
}

void Structure::RemoveFusedFromGeneral() {
  is_fused_.assign(landmarks_.size(), 0);
  for (const FusedLandmark& fused : fused_)
    is_fused_[Index(fused.landmark)] = 1;
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
    if (is_fused_[l] != 0) continue;
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
  num_landmark_scalars_ += static_cast<int>(plan_.landmark_of_lane.size());
}

// What the groups contribute to H_pp and S, and who computes them: needs the pose blocks' pairs.
void Structure::FinishReprojectionPlan() {
  chain_of_row_.assign(poses_.size(), -1);
  next_in_row_.clear();
  for (ReprojectionGroup& group : plan_.groups) {
    frames_.clear();
    frames_.push_back(group.host.block);
    for (std::int32_t p = group.pair_begin; p < group.pair_end; ++p) {
      ReprojectionPair& pair = plan_.pairs[Index(p)];
      frames_.push_back(pair.target.block);
      if (group.host.block < 0 || pair.target.block < 0) continue;
      pair.h_transposed = group.host.block < pair.target.block;
      pair.h_block = pair.h_transposed ? PairOffset(pair.target.block, group.host.block)
                                       : PairOffset(group.host.block, pair.target.block);
    }
    group.map_begin = static_cast<std::int32_t>(plan_.block_map.size());
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const std::int32_t a = frames_[i], b = frames_[j];
        if (a < 0 || b < 0) {
          plan_.block_map.push_back(ReprojectionPlan::kNoBlock);
        } else {
          const std::int32_t block = PlanBlock(std::max(a, b), std::min(a, b));
          plan_.block_map.push_back(a >= b ? block : ~block);
        }
      }
    }
  }
  // Chunks: groups shared out evenly by their observations.
  plan_.chunk_begin.assign(1, 0);
  const std::int64_t total = static_cast<std::int64_t>(plan_.edge_of_slot.size());
  std::int64_t done = 0;
  std::size_t g = 0;
  for (int c = 1; c <= num_chunks_; ++c) {
    while (g < plan_.groups.size() && done < total * c / num_chunks_) {
      for (std::int32_t p = plan_.groups[g].pair_begin; p < plan_.groups[g].pair_end; ++p) {
        done += plan_.pairs[Index(p)].lanes;
      }
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
