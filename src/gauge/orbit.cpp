// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/gauge/orbit.h"

#include <algorithm>

#include "glissade/graph/pools.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"

namespace glissade {

namespace {

using RowMajor3 = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
using Block = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

/// p_B_C of all cameras.
class LeverSearch {
 public:
  void Add(const double* p) {
    if (!found_) std::copy_n(p, 3, lever_);
    one_ = one_ && std::equal(p, p + 3, lever_);
    found_ = true;
  }
  [[nodiscard]] bool one() const { return one_; }
  void Write(double* lever) const { std::copy_n(lever_, 3, lever); }

 private:
  bool found_ = false, one_ = true;
  double lever_[3] = {0, 0, 0};
};

/// Adds the cameras that the edges of a pool carry.
void AddLevers(const EdgePoolBase& pool, LeverSearch* levers) {
  const double body[3] = {0, 0, 0};
  for (int edge = 0; edge < pool.size() && levers->one(); ++edge) {
    if (!pool.Alive(edge)) continue;
    const double* extrinsic = pool.Extrinsic(edge);
    levers->Add(extrinsic != nullptr ? extrinsic : body);
  }
}

}  // namespace

Result<Orbit> Orbit::Of(const Graph& graph, GaugeGroup group) {
  Orbit orbit;
  if (group != GaugeGroup::kAuto && Dimension(group) == 0) {
    return Status(StatusCode::kInvalidArgument, "gauge: group is no GaugeGroup");
  }
  if (graph.NumVertices<VertexPose>() == 0) {
    return Status(StatusCode::kInvalidArgument, "gauge: the graph has no VertexPose");
  }
  LeverSearch levers;
  bool monocular = true;
  for (const auto& pool : graph.edge_pools()) {
    if (pool->slots().NumAlive() == 0) continue;
    const EdgeTraits& traits = pool->traits();
    monocular = monocular && traits.scale_rule != ScaleRule::kMetric;
    if (traits.extrinsic_vertex < 0) continue;
    for (int edge = 0; edge < pool->size(); ++edge) {
      if (!pool->Alive(edge)) continue;
      const AnyVertex vertex = pool->VertexOf(edge, traits.extrinsic_vertex);
      const auto& known = orbit.extrinsics_;
      if (std::find(known.begin(), known.end(), vertex) != known.end()) continue;
      orbit.extrinsics_.push_back(vertex);
      const VertexPoolBase* poses = pool->vertex_pool(edge, traits.extrinsic_vertex);
      levers.Add(poses->Data(poses->slots().IndexOf(vertex.slot)));
    }
  }
  if (group == GaugeGroup::kAuto && graph.NumVertices<VertexSpeedBias>() > 0) {
    group = GaugeGroup::kVisualInertial;
  }
  if (group == GaugeGroup::kAuto || group == GaugeGroup::kMono) {
    for (const auto& pool : graph.edge_pools()) {
      const EdgeTraits& traits = pool->traits();
      if (traits.scale_rule == ScaleRule::kRays && traits.extrinsic_vertex < 0) {
        AddLevers(*pool, &levers);
      }
    }
    if (group == GaugeGroup::kAuto) {
      group = monocular && levers.one() ? GaugeGroup::kMono : GaugeGroup::kStereo;
    }
    if (group == GaugeGroup::kMono) levers.Write(orbit.lever_);
  }
  orbit.group_ = group;
  return orbit;
}

bool Orbit::Moves(AnyVertex vertex) const {
  if (vertex.type == &kTypeInfo<VertexPose>) {
    return std::find(extrinsics_.begin(), extrinsics_.end(), vertex) == extrinsics_.end();
  }
  return vertex.type == &kTypeInfo<VertexPointXYZ> ||
         (vertex.type == &kTypeInfo<VertexSpeedBias> && group_ == GaugeGroup::kVisualInertial) ||
         (vertex.type == &kTypeInfo<VertexInverseDepth> && group_ == GaugeGroup::kMono);
}

void Orbit::Directions(AnyVertex vertex, const double* state, double* U) const {
  const int n = dim();
  const int rotations = group_ == GaugeGroup::kVisualInertial ? 1 : 3;
  if (vertex.type == &kTypeInfo<VertexInverseDepth>) {
    std::fill_n(U, n, 0.0);
    U[n - 1] = -state[0];
    return;
  }
  const int rows = vertex.type == &kTypeInfo<VertexPose>        ? 6
                   : vertex.type == &kTypeInfo<VertexSpeedBias> ? 9
                                                                : 3;
  std::fill_n(U, rows * n, 0.0);
  const Vector3 x(state[0], state[1], state[2]);
  const bool is_velocity = rows == 9;
  for (int r = 0; r < rotations; ++r) {
    const int axis = rotations == 1 ? 2 : r;
    const Vector3 turned = Vector3(Vector3::Unit(axis)).cross(x);
    for (int k = 0; k < 3; ++k)
      U[k * n + r] = turned[k];
  }
  for (int k = 0; k < 3 && !is_velocity; ++k)
    U[k * n + rotations + k] = 1.0;
  if (group_ == GaugeGroup::kMono) {
    for (int k = 0; k < 3; ++k)
      U[k * n + n - 1] = x[k];
  }
  if (rows != 6) return;
  const Matrix3 R = RotationMatrix(state + 3);
  for (int r = 0; r < rotations; ++r) {
    const int axis = rotations == 1 ? 2 : r;
    for (int k = 0; k < 3; ++k)
      U[(3 + k) * n + r] = R(axis, k);
  }
  if (group_ == GaugeGroup::kMono) {
    const Vector3 lever = R * Vector3(lever_[0], lever_[1], lever_[2]);
    for (int k = 0; k < 3; ++k)
      U[k * n + n - 1] += lever[k];
  }
}

void Orbit::Move(const OrbitMotion& g, AnyVertex vertex, double* state) const {
  if (!Moves(vertex)) return;
  if (vertex.type == &kTypeInfo<VertexInverseDepth>) {
    state[0] /= g.scale;
    return;
  }
  const Matrix3 R = RowMajor3(g.R);
  const Vector3 x(state[0], state[1], state[2]);
  const Vector3 t(g.t[0], g.t[1], g.t[2]);
  Vector3 moved = R * x;
  if (vertex.type == &kTypeInfo<VertexSpeedBias>) {
    std::copy_n(moved.data(), 3, state);
    return;
  }
  moved = g.scale * moved + t;
  if (vertex.type == &kTypeInfo<VertexPose>) {
    if (g.scale != 1.0) {
      const Vector3 lever(lever_[0], lever_[1], lever_[2]);
      moved += (g.scale - 1.0) * (R * (RotationMatrix(state + 3) * lever));
    }
    Quaternion q = Quaternion(R) * Quaternion(state + 3);
    q.normalize();
    std::copy_n(q.coeffs().data(), 4, state + 3);
  }
  std::copy_n(moved.data(), 3, state);
}

void Orbit::Derivative(const OrbitMotion& g, AnyVertex vertex, const double* state,
                       double* D) const {
  const int rows = vertex.type == &kTypeInfo<VertexPose>           ? 6
                   : vertex.type == &kTypeInfo<VertexSpeedBias>    ? 9
                   : vertex.type == &kTypeInfo<VertexInverseDepth> ? 1
                                                                   : 3;
  Block d(D, rows, rows);
  d.setIdentity();
  if (rows == 1) {
    d(0, 0) = 1.0 / g.scale;
    return;
  }
  const Matrix3 R = RowMajor3(g.R);
  d.topLeftCorner(3, 3) = rows == 9 ? R : Matrix3(g.scale * R);
  if (rows == 6 && g.scale != 1.0) {
    const Vector3 lever(lever_[0], lever_[1], lever_[2]);
    d.topRightCorner(3, 3) = (1.0 - g.scale) * (R * RotationMatrix(state + 3) * so3::Hat(lever));
  }
}

}  // namespace glissade
