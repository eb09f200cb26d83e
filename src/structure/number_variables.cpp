// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Which variable each vertex is, and where its part of the step lies.

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/structure/structure.h"
#include "structure/inactive.h"

namespace glissade {

using internal::Index;

void Structure::NumberVariables(const Graph& graph) {
  const auto& pools = graph.vertex_pools();
  variable_.resize(pools.size());
  touched_.resize(pools.size());
  step_offsets_.resize(pools.size());
  for (std::size_t p = 0; p < pools.size(); ++p) {
    variable_[p].assign(Index(pools[p]->size()), kInactive);
    touched_[p].assign(Index(pools[p]->size()), 0);
    step_offsets_[p].assign(Index(pools[p]->size()), -1);
  }
  // A vertex without edges has no information: it is left out rather than made a zero row.
  for (const FlatEdges& edges : flat_) {
    edges.ForEachPool([&](std::size_t pool, std::size_t first, std::size_t step) {
      std::uint8_t* const touched = touched_[pool].data();
      const std::size_t size = edges.index.size();
      for (std::size_t k = first; k < size; k += step)
        touched[edges.index[k]] = 1;
    });
  }
  poses_.clear();
  landmarks_.clear();
  pose_offsets_.assign(1, 0);
  num_landmark_scalars_ = 0;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const VertexPoolBase& pool = *pools[p];
    const int dim = pool.ops().tangent_dim;
    for (int k = 0; k < pool.size(); ++k) {
      if (pool.fix(k) == Fix::kWhole || touched_[p][Index(k)] == 0) continue;
      if (pool.eliminated(k)) {
        variable_[p][Index(k)] = ~static_cast<std::int32_t>(landmarks_.size());
        landmarks_.push_back(
            {static_cast<std::int32_t>(p), k, dim, 0, num_landmark_scalars_, 0, 0});
        num_landmark_scalars_ += dim;
      } else {
        variable_[p][Index(k)] = static_cast<std::int32_t>(poses_.size());
        poses_.push_back({static_cast<std::int32_t>(p), k, pose_offsets_.back(), dim, 0, -1});
        step_offsets_[p][Index(k)] = pose_offsets_.back();
        pose_offsets_.push_back(pose_offsets_.back() + dim);
      }
    }
  }
  for (FlatEdges& edges : flat_) {
    edges.variable.resize(edges.index.size());
    edges.ForEachPool([&](std::size_t pool, std::size_t first, std::size_t step) {
      const std::int32_t* const variable = variable_[pool].data();
      const std::size_t size = edges.index.size();
      for (std::size_t k = first; k < size; k += step)
        edges.variable[k] = variable[edges.index[k]];
    });
  }
  const auto& tangents = graph.free_tangents();
  for (std::size_t t = 0; t < tangents.size(); ++t) {
    const VertexPoolBase* pool = graph.PoolOf(tangents[t].vertex.type);
    const int index = pool->slots().IndexOf(tangents[t].vertex.slot);
    const std::int32_t block = variable_[Index(pool->id())][Index(index)];
    if (block == kInactive) continue;
    poses_[Index(block)].free_tangent = static_cast<std::int32_t>(t);
    step_offsets_[Index(pool->id())][Index(index)] = -1;
  }
}

void Structure::NumberLandmarkSteps() {
  for (const LandmarkBlock& landmark : landmarks_) {
    step_offsets_[Index(landmark.pool)][Index(landmark.index)] = num_pose_scalars() + landmark.step;
  }
  for (const LandmarkGroup& group : plan_.groups) {
    std::vector<std::int32_t>& offsets = step_offsets_[Index(group.pool)];
    const std::int32_t first = num_pose_scalars() + plan_.first_step + group.step_begin;
    for (std::int32_t lane = 0; lane < group.used; ++lane)
      offsets[Index(plan_.landmark_of_lane[Index(group.lane_begin + lane)])] =
          first + group.dim * lane;
  }
}

}  // namespace glissade
