// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "gauge/gauge_vectors.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/vertices/inverse_depth.h"

namespace glissade {

namespace {

using internal::Index;

/// U <- E^+ U with zeros below, E the basis of the free tangent. False where U does not lie in its
/// span.
bool ToFreeCoordinates(const FreeTangent& tangent, int n, double* U) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 9, 9>;
  Eigen::Map<Rows> u(U, tangent.tangent_dim, n);
  const Eigen::Map<const Rows> E(tangent.basis, tangent.tangent_dim, tangent.free_dim);
  const Rows gram = E.transpose() * E;
  const Rows d = gram.llt().solve(Rows(E.transpose() * u));
  const bool inside = (u - E * d).norm() <= 1e-12 * u.norm();
  u.setZero();
  if (inside) u.topRows(tangent.free_dim) = d;
  return inside;
}

}  // namespace

const double* GaugeState(const VertexPoolBase& pool, int index, const LinearizedStates& point) {
  // Inverse depths are always linearized where they are.
  const bool inverse_depth = pool.ops().type == &kTypeInfo<VertexInverseDepth>;
  const double* first = inverse_depth ? nullptr : pool.first_estimates().At(index);
  return first != nullptr ? first : point.State(pool, index);
}

GaugeVectors::GaugeVectors(const Graph& graph, const Structure& structure,
                           const LinearizedStates& point, const Orbit& orbit,
                           std::vector<AnyVertex>* held)
    : dim_(orbit.dim()), num_poses_(static_cast<int>(structure.poses().size())) {
  begin_.assign(structure.poses().size() + structure.landmarks().size(), -1);
  std::size_t size = 0;
  for (const PoseBlock& pose : structure.poses())
    size += Index(pose.dim);
  values_.reserve((size + Index(structure.num_landmark_scalars())) * Index(dim_));
  double U[Orbit::kMaxTangent * Orbit::kMaxDim];
  const auto add = [&](std::size_t block, const VertexPoolBase& pool, int index, int rows,
                       const FreeTangent* tangent) {
    const AnyVertex vertex = pool.HandleAt(index);
    if (!orbit.Moves(vertex)) return;
    orbit.Directions(vertex, GaugeState(pool, index, point), U);
    if (tangent != nullptr && !ToFreeCoordinates(*tangent, dim_, U)) {
      held->push_back(vertex);
      return;
    }
    begin_[block] = static_cast<int>(values_.size());
    values_.insert(values_.end(), U, U + rows * dim_);
  };
  for (std::size_t k = 0; k < structure.poses().size(); ++k) {
    const PoseBlock& pose = structure.poses()[k];
    const FreeTangent* tangent =
        pose.free_tangent < 0 ? nullptr : &graph.free_tangents()[Index(pose.free_tangent)];
    add(k, *graph.vertex_pools()[Index(pose.pool)], pose.index, pose.dim, tangent);
  }
  for (std::size_t l = 0; l < structure.landmarks().size(); ++l) {
    const LandmarkBlock& landmark = structure.landmarks()[l];
    add(structure.poses().size() + l, *graph.vertex_pools()[Index(landmark.pool)], landmark.index,
        landmark.dim, nullptr);
  }
  for (const auto& pool : graph.vertex_pools()) {
    for (int k = 0; k < pool->size(); ++k) {
      if (pool->fix(k) == Fix::kWhole && pool->slots().AliveAt(k) &&
          orbit.Moves(pool->HandleAt(k))) {
        held->push_back(pool->HandleAt(k));
      }
    }
  }
  FillLanes(graph, structure, point, orbit);
}

void GaugeVectors::FillLanes(const Graph& graph, const Structure& structure,
                             const LinearizedStates& point, const Orbit& orbit) {
  const LandmarkPlan& plan = structure.groups();
  const bool has_scale = orbit.group() == GaugeGroup::kMono;
  first_of_lanes_ = dim_;
  for (const LandmarkGroup& group : plan.groups) {
    if (group.dim > 1) first_of_lanes_ = 0;
  }
  // Inverse depths move with the scale only, the last direction.
  if (has_scale && !plan.empty()) first_of_lanes_ = std::min(first_of_lanes_, dim_ - 1);
  if (first_of_lanes_ == dim_) return;
  lanes_.assign(Index(plan.step_size) * Index(dim_), 0.0);
  for (const LandmarkGroup& group : plan.groups) {
    const VertexPoolBase& pool = *graph.vertex_pools()[Index(group.pool)];
    double* rows = lanes_.data() + Index(group.step_begin) * Index(dim_);
    for (std::int32_t s = 0; s < group.used; ++s, rows += group.dim * dim_) {
      const std::int32_t landmark = plan.landmark_of_lane[Index(group.lane_begin + s)];
      const double* state = GaugeState(pool, landmark, point);
      if (group.dim > 1) {
        orbit.Directions(pool.HandleAt(landmark), state, rows);
      } else if (has_scale) {
        rows[dim_ - 1] = -state[0];
      }
    }
  }
}

std::vector<double> GaugeVectors::Lanes(const Structure& structure, int direction) const {
  std::vector<double> u(Index(structure.num_pose_scalars() + structure.num_landmark_scalars()),
                        0.0);
  double* out = u.data() + structure.num_pose_scalars() + structure.groups().first_step;
  for (std::size_t k = Index(direction); k < lanes_.size(); k += Index(dim_))
    *out++ = lanes_[k];
  return u;
}

std::vector<double> GaugeVectors::Whole(const Structure& structure, int direction) const {
  std::vector<double> u = Lanes(structure, direction);
  const auto copy = [&](const double* from, int rows, int to) {
    for (int r = 0; from != nullptr && r < rows; ++r)
      u[Index(to + r)] = from[r * dim_ + direction];
  };
  for (std::size_t k = 0; k < structure.poses().size(); ++k) {
    copy(Pose(static_cast<int>(k)), structure.poses()[k].dim, structure.poses()[k].offset);
  }
  for (std::size_t l = 0; l < structure.landmarks().size(); ++l) {
    copy(Landmark(static_cast<int>(l)), structure.landmarks()[l].dim,
         structure.num_pose_scalars() + structure.landmarks()[l].step);
  }
  return u;
}

}  // namespace glissade
