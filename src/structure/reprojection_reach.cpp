// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The center of the fused path, and who is too far from it: ReprojectionPlan::kMaxReach.

#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/edges/reprojection.h"
#include "glissade/structure/structure.h"

namespace glissade {

namespace {

std::size_t Index(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

/// Position of a pose as seen from o.
Vector3 PositionFrom(const double* o, const VertexPool<VertexPose>& poses, std::int32_t pose) {
  const double* p = poses.At(pose).pose.data;
  return {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
}

}  // namespace

// fused_ is sorted by group.
void Structure::ChooseCenter(const Graph& graph) {
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  double median[3];
  for (int axis = 0; axis < 3; ++axis) {
    coordinates_.clear();
    for (const ReprojectionGroup& group : plan_.groups)
      coordinates_.push_back({poses.At(group.host.pose).pose.data[axis], 0});
    for (const FusedLandmark& landmark : fused_)
      ++coordinates_[Index(landmark.group)].landmarks;
    std::sort(
        coordinates_.begin(), coordinates_.end(),
        [](const WeightedCoordinate& a, const WeightedCoordinate& b) { return a.value < b.value; });
    const auto total = static_cast<std::int64_t>(fused_.size());
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
  for (const ReprojectionGroup& group : plan_.groups) {
    const double distance = PositionFrom(median, poses, group.host.pose).norm();
    if (distance < nearest) {
      nearest = distance;
      plan_.center = group.host.pose;
    }
  }
}

void Structure::LeaveOutFarLandmarks(const Graph& graph) {
  const EdgePool<EdgeReprojection>& pool = *graph.Pool<EdgeReprojection>();
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  const VertexPool<VertexInverseDepth>& depths = *graph.Pool<VertexInverseDepth>();
  std::int32_t pool_id = 0;
  while (graph.edge_pools()[Index(pool_id)].get() != &pool)
    ++pool_id;
  const FlatEdges& flat = flat_[Index(pool_id)];
  const double* o = poses.At(plan_.center).pose.data;

  std::size_t kept = 0;
  std::int32_t kept_groups = 0, group = -1;
  Vector3 host = Vector3::Zero(), camera = Vector3::Zero();  // of the group, from o
  Matrix3 R_w_c = Matrix3::Identity();
  for (std::size_t k = 0; k < fused_.size(); ++k) {
    const FusedLandmark fused = fused_[k];
    if (fused.group != group) {
      group = fused.group;
      const ReprojectionGroup& of = plan_.groups[Index(group)];
      const Pose& T_b_c = pool.At(of.edge).T_b_c;
      const Matrix3 R_w_b = poses.At(of.host.pose).pose.R();
      host = PositionFrom(o, poses, of.host.pose);
      camera = host + R_w_b * T_b_c.p();
      R_w_c = R_w_b * T_b_c.R();
    }
    const EdgeReprojection& first =
        pool.At(landmark_edges_[Index(landmark_edges_begin_[Index(fused.landmark)])].edge);
    const double rho = depths.At(landmarks_[Index(fused.landmark)].index).rho;
    bool near = true;
    if (rho != 0.0) {  // else it is at infinity
      const Vector3 X = camera + R_w_c * (Vector3(first.uv_host[0], first.uv_host[1], 1.0) / rho);
      const auto within = [&](const Vector3& p) {
        return p.norm() <= ReprojectionPlan::kMaxReach * (X - p).norm();
      };
      near = within(host);
      ForEachEdgeOf(fused.landmark, [&](std::int32_t edge) {
        near = near && within(PositionFrom(o, poses, flat.index[Index(3 * edge + 1)]));
      });
    }
    if (!near) continue;
    if (kept == 0 || plan_.groups[Index(kept_groups - 1)].edge != plan_.groups[Index(group)].edge) {
      plan_.groups[Index(kept_groups++)] = plan_.groups[Index(group)];
    }
    fused_[kept++] = {kept_groups - 1, fused.length, fused.landmark};
  }
  fused_.resize(kept);
  plan_.groups.resize(Index(kept_groups));
}

double Structure::Reach(const Graph& graph) const {
  double reach = 0.0;
  if (plan_.empty()) return reach;
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  const double* o = poses.At(plan_.center).pose.data;
  const auto look = [&](std::int32_t pose) {
    reach = std::max(reach, PositionFrom(o, poses, pose).norm());
  };
  for (const ReprojectionGroup& group : plan_.groups)
    look(group.host.pose);
  for (const ReprojectionPair& pair : plan_.pairs)
    look(pair.target.pose);
  return reach;
}

}  // namespace glissade
