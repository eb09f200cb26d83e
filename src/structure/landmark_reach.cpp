// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The center of the twists, and which landmarks are too far from it: LandmarkPlan::kMaxReach.

#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/structure/structure.h"

namespace glissade {

namespace {

using internal::Index;

/// Position of a pose as seen from o.
Vector3 PositionFrom(const double* o, const VertexPool<VertexPose>& poses, std::int32_t pose) {
  const double* p = poses.At(pose).pose.data;
  return {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
}

}  // namespace

// grouped_ is sorted by group.
void Structure::ChooseCenter(const Graph& graph) {
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  double median[3];
  for (int axis = 0; axis < 3; ++axis) {
    coordinates_.clear();
    for (const LandmarkGroup& group : plan_.groups)
      coordinates_.push_back({poses.At(group.host.pose).pose.data[axis], 0});
    for (const GroupedLandmark& landmark : grouped_)
      ++coordinates_[Index(landmark.group)].landmarks;
    std::sort(
        coordinates_.begin(), coordinates_.end(),
        [](const WeightedCoordinate& a, const WeightedCoordinate& b) { return a.value < b.value; });
    const auto total = static_cast<std::int64_t>(grouped_.size());
    std::int64_t below = 0;
    for (const WeightedCoordinate& x : coordinates_) {
      below += x.landmarks;
      median[axis] = x.value;
      if (2 * below >= total) break;
    }
  }
  // A host, not the median itself, which need not be near anything.
  double nearest = std::numeric_limits<double>::infinity();
  plan_.center = plan_.groups.front().host.pose;
  for (const LandmarkGroup& group : plan_.groups) {
    const double distance = PositionFrom(median, poses, group.host.pose).norm();
    if (distance < nearest) {
      nearest = distance;
      plan_.center = group.host.pose;
    }
  }
}

void Structure::LeaveOutFarLandmarks(const Graph& graph) {
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  const VertexPool<VertexInverseDepth>& depths = *graph.Pool<VertexInverseDepth>();
  const double* o = poses.At(plan_.center).pose.data;
  distance_.resize(Index(poses.size()));
  for (int k = 0; k < poses.size(); ++k)
    distance_[Index(k)] = PositionFrom(o, poses, k).norm();

  std::size_t kept = 0;
  std::int32_t kept_groups = 0;
  for (const GroupedLandmark landmark : grouped_) {
    const double rho = std::abs(depths.At(landmarks_[Index(landmark.landmark)].index).rho);
    const LandmarkGroup& group = plan_.groups[Index(landmark.group)];
    double farthest = distance_[Index(group.host.pose)];
    ForEachEdgeOf(landmark.landmark, [&](const EdgeRef& ref) {
      if (pool_kind_[Index(ref.pool)] != PoolKind::kHostAndTarget) return;
      const std::size_t target = 3 * Index(ref.edge) + 1;
      farthest = std::max(farthest, distance_[Index(flat_[Index(ref.pool)].index[target])]);
    });
    if (!(farthest * rho <= LandmarkPlan::kMaxReach)) continue;
    if (kept == 0 || plan_.groups[Index(kept_groups - 1)].host.pose != group.host.pose) {
      plan_.groups[Index(kept_groups++)] = group;
    }
    grouped_[kept++] = {kept_groups - 1, landmark.length, landmark.landmark};
  }
  grouped_.resize(kept);
  plan_.groups.resize(Index(kept_groups));
}

// Of a lane: the farthest of its host and of the targets whose lanes reach to it, over its depth. A
// lane that one of these has a gap at counts as seen by it.
double Structure::Reach(const Graph& graph) const {
  double reach = 0.0;
  if (plan_.empty()) return reach;
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  const VertexPool<VertexInverseDepth>& depths = *graph.Pool<VertexInverseDepth>();
  const double* o = poses.At(plan_.center).pose.data;
  for (const LandmarkGroup& group : plan_.groups) {
    // Targets come by falling number of lanes: the last lanes see the fewest.
    double farthest = PositionFrom(o, poses, group.host.pose).norm();
    std::int32_t pair = group.pair_begin;
    std::int32_t end = group.lanes;
    while (end > 0) {
      while (pair < group.pair_end && plan_.pairs[Index(pair)].lanes >= end) {
        farthest =
            std::max(farthest, PositionFrom(o, poses, plan_.pairs[Index(pair)].target.pose).norm());
        ++pair;
      }
      const std::int32_t begin = pair < group.pair_end ? plan_.pairs[Index(pair)].lanes : 0;
      double nearest = 0.0;
      for (std::int32_t lane = begin; lane < end; ++lane) {
        const std::int32_t landmark = plan_.landmark_of_lane[Index(group.lane_begin + lane)];
        if (landmark >= 0) nearest = std::max(nearest, std::abs(depths.At(landmark).rho));
      }
      reach = std::max(reach, farthest * nearest);
      end = begin;
    }
  }
  return reach;
}

}  // namespace glissade
