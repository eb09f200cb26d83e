// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The center of the twists; which landmarks are too far from it (LandmarkPlan::kMaxReach), and
// which groups of points are too sparse (kMaxFill).

#include <algorithm>
#include <cmath>
#include <functional>
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

/// How often a distance from the center is that from a landmark. Infinite where the landmark is at
/// the pose, also at that of the center.
double Ratio(double from_center, double from_landmark) {
  return from_landmark > 0.0 ? from_center / from_landmark
                             : std::numeric_limits<double>::infinity();
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

// Landmarks that keeps(landmark, its group) says yes to, and the groups that have any.
template <class F>
void Structure::KeepGrouped(F&& keeps) {
  std::size_t kept = 0;
  std::int32_t kept_groups = 0, newest = -1;
  for (const GroupedLandmark landmark : grouped_) {
    const LandmarkGroup group = plan_.groups[Index(landmark.group)];
    if (!keeps(landmark, group)) continue;
    if (landmark.group != newest) plan_.groups[Index(kept_groups++)] = group;
    newest = landmark.group;
    grouped_[kept++] = {kept_groups - 1, landmark.length, landmark.landmark};
  }
  grouped_.resize(kept);
  plan_.groups.resize(Index(kept_groups));
}

void Structure::LeaveOutFarLandmarks(const Graph& graph) {
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  const double* o = poses.At(plan_.center).pose.data;
  distance_.resize(Index(poses.size()));
  for (int k = 0; k < poses.size(); ++k)
    distance_[Index(k)] = PositionFrom(o, poses, k).norm();

  KeepGrouped([&](const GroupedLandmark& landmark, const LandmarkGroup& group) {
    const std::int32_t index = landmarks_[Index(landmark.landmark)].index;
    double reach = 0.0;
    if (group.dim == 1) {
      double farthest = distance_[Index(group.host.pose)];
      ForEachObserverOf(landmark.landmark, [&](std::int32_t pose) {
        farthest = std::max(farthest, distance_[Index(pose)]);
      });
      reach = farthest * std::abs(graph.Pool<VertexInverseDepth>()->At(index).rho);
    } else {
      const double* x = graph.Pool<VertexPointXYZ>()->At(index).data;
      double square = 0.0;
      ForEachObserverOf(landmark.landmark, [&](std::int32_t pose) {
        const double from_center = distance_[Index(pose)];
        square = std::max(
            square, Ratio(from_center * from_center, PositionFrom(x, poses, pose).squaredNorm()));
      });
      reach = std::sqrt(square);
    }
    return reach <= LandmarkPlan::kMaxReach;
  });
}

void Structure::LeaveOutSparseGroups(const Graph& graph) {
  if (grouped_.empty()) return;
  pair_of_pose_.assign(Index(graph.Pool<VertexPose>()->size()), -1);
  is_sparse_.assign(plan_.groups.size(), 0);
  std::size_t begin = 0;
  for (std::size_t g = 0; g < plan_.groups.size(); ++g) {
    std::size_t end = begin;
    while (end < grouped_.size() && grouped_[end].group == static_cast<std::int32_t>(g))
      ++end;
    if (plan_.groups[g].dim > 1) is_sparse_[g] = IsSparse(begin, end) ? 1 : 0;
    begin = end;
  }
  if (std::find(is_sparse_.begin(), is_sparse_.end(), 1) == is_sparse_.end()) return;
  KeepGrouped([&](const GroupedLandmark& landmark, const LandmarkGroup&) {
    return is_sparse_[Index(landmark.group)] == 0;
  });
}

// Blocks of S that a group of points [begin, end) fills, once per lane, against those that its
// points fill: a frame that sees lanes up to the n-th has n of them with each frame that sees more.
bool Structure::IsSparse(std::size_t begin, std::size_t end) {
  last_lanes_.clear();
  frames_.clear();
  std::int64_t blocks = 0;
  for (std::size_t k = begin; k < end; ++k) {
    std::int64_t seen = 0;
    const auto lane = static_cast<std::int32_t>(k - begin) + 1;
    ForEachObserverOf(grouped_[k].landmark, [&](std::int32_t pose) {
      std::int32_t& frame = pair_of_pose_[Index(pose)];
      if (frame < 0) {
        frame = static_cast<std::int32_t>(frames_.size());
        frames_.push_back(pose);
        last_lanes_.push_back(0);
      }
      if (last_lanes_[Index(frame)] == lane) return;
      last_lanes_[Index(frame)] = lane;
      ++seen;
    });
    blocks += seen * (seen + 1) / 2;
  }
  for (const std::int32_t pose : frames_)
    pair_of_pose_[Index(pose)] = -1;
  std::sort(last_lanes_.begin(), last_lanes_.end(), std::greater<>());
  std::int64_t filled = 0, frames = 0;
  for (const std::int32_t lanes : last_lanes_)
    filled += lanes * ++frames;
  return filled > LandmarkPlan::kMaxFill * blocks;
}

double Structure::Reach(const Graph& graph) const {
  double reach = 0.0;
  for (const LandmarkGroup& group : plan_.groups) {
    reach =
        std::max(reach, group.dim == 1 ? ReachOfDepths(graph, group) : ReachOfPoints(graph, group));
  }
  return reach;
}

// Of a lane: the farthest of its host and of the targets whose lanes reach to it, over its depth. A
// lane that one of these has a gap at counts as seen by it.
double Structure::ReachOfDepths(const Graph& graph, const LandmarkGroup& group) const {
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  const VertexPool<VertexInverseDepth>& depths = *graph.Pool<VertexInverseDepth>();
  const double* o = poses.At(plan_.center).pose.data;
  // Targets come by falling number of lanes: the last lanes see the fewest.
  double reach = 0.0;
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
  return reach;
}

// Of the nearest point that each pose sees. Lanes without an edge repeat one that has.
double Structure::ReachOfPoints(const Graph& graph, const LandmarkGroup& group) const {
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  const VertexPool<VertexPointXYZ>& points = *graph.Pool<VertexPointXYZ>();
  const double* o = poses.At(plan_.center).pose.data;
  double reach = 0.0;
  for (std::int32_t r = group.run_begin; r < group.run_end; ++r) {
    const LandmarkRun& run = plan_.runs[Index(r)];
    if (run.pair < 0) continue;
    const std::int32_t pose = plan_.pairs[Index(run.pair)].target.pose;
    const double* p = poses.At(pose).pose.data;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::int32_t s = run.begin; s < run.begin + run.used - run.first; ++s) {
      const double* x = points.At(plan_.landmark_of_slot[Index(s)]).data;
      const double dx = x[0] - p[0], dy = x[1] - p[1], dz = x[2] - p[2];
      nearest = std::min(nearest, dx * dx + dy * dy + dz * dz);
    }
    reach = std::max(reach, Ratio(PositionFrom(o, poses, pose).norm(), std::sqrt(nearest)));
  }
  return reach;
}

}  // namespace glissade
