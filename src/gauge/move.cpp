// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/gauge/move.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gauge/gauge_breaches.h"
#include "gauge/move_priors.h"
#include "glissade/gauge/constraint.h"
#include "glissade/graph/pools.h"

namespace glissade {

namespace {

using RowMajor3 = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

Status Refuse(const std::string& what) {
  return {StatusCode::kInvalidArgument, "MoveAlongOrbit: " + what};
}

Status CheckMotion(const OrbitMotion& g, GaugeGroup group) {
  const RowMajor3 R(g.R);
  const bool finite = internal::AllFinite(g.R, 9) && internal::AllFinite(g.t, 3) &&
                      internal::AllFinite(&g.scale, 1);
  if (!finite) return {StatusCode::kNotFinite, "MoveAlongOrbit: the motion is not finite"};
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > 1e-9 || R.determinant() < 0.0) return Refuse("R is not a rotation");
  if (!(g.scale > 0.0)) return Refuse("the scale must be positive");
  if (group != GaugeGroup::kMono && g.scale != 1.0) return Refuse("the scale is observed");
  if (group == GaugeGroup::kVisualInertial && std::abs(g.R[8] - 1.0) > 1e-12) {
    return Refuse("roll and pitch are observed: R must turn about z");
  }
  return {};
}

/// Edges that see the gauge, of those that are not to be moved.
std::vector<AnyEdge> Obstacles(const Graph& graph, const Orbit& orbit, const MoveOptions& options) {
  LinearizedStates point;
  point.Keep(graph);
  GaugeBreaches breaches(graph, point, orbit, 0.0, BreachPoint::kPresent);
  std::vector<AnyEdge> found;
  double sum[Orbit::kMaxDim], free_sum[Orbit::kMaxDim];
  for (const auto& pool : graph.edge_pools()) {
    if (options.move_absolute_priors && IsMovablePrior(*pool->type())) continue;
    for (int edge = 0; edge < pool->size(); ++edge) {
      if (!pool->Alive(edge) || IsMarginalPrior(*pool, edge)) continue;
      if (!breaches.Evaluate(*pool, edge, free_sum, sum)) continue;
      if (!breaches.blind()) found.push_back(pool->HandleAt(edge));
    }
  }
  return found;
}

Status RefuseEdges(const std::vector<AnyEdge>& edges) {
  std::string names;
  for (std::size_t k = 0; k < std::min<std::size_t>(edges.size(), 20); ++k)
    names += (k == 0 ? "" : ", ") + ToString(edges[k]);
  if (edges.size() > 20) names += ", ...";
  return {StatusCode::kInvalidArgument, "MoveAlongOrbit: not blind to the gauge: " + names,
          edges.front()};
}

/// Stops at the first vertex that overflows: no edge need tell, where none is on it.
Status MoveStates(const OrbitMotion& g, const Orbit& orbit, Graph* graph) {
  std::vector<double> first;
  const auto overflow = [](AnyVertex vertex) {
    return Status(StatusCode::kNotFinite,
                  "MoveAlongOrbit: " + ToString(vertex) + " would not stay finite", vertex);
  };
  for (const auto& pool : graph->vertex_pools()) {
    for (int k = 0; k < pool->size(); ++k) {
      if (!pool->slots().AliveAt(k)) continue;
      const AnyVertex vertex = pool->HandleAt(k);
      if (!orbit.Moves(vertex)) continue;
      orbit.Move(g, vertex, pool->Data(k));
      if (!internal::AllFinite(pool->Data(k), pool->ops().ambient_dim)) return overflow(vertex);
      const double* x_lin = pool->first_estimates().At(k);
      if (x_lin == nullptr) continue;
      first.assign(x_lin, x_lin + pool->ops().ambient_dim);
      orbit.Move(g, vertex, first.data());
      if (!internal::AllFinite(first.data(), pool->ops().ambient_dim)) return overflow(vertex);
      pool->SetFirstEstimate(k, first.data());
    }
  }
  const Matrix3 R = RowMajor3(g.R);
  for (FreeTangent& tangent : graph->free_tangents()) {
    // Exp(dphi) R0 -> R Exp(dphi) R0 = Exp(R dphi) R R0.
    Quaternion q0 = Quaternion(R) * Quaternion(tangent.q0);
    q0.normalize();
    const Vector3 dphi = R * Vector3(tangent.dphi[0], tangent.dphi[1], tangent.dphi[2]);
    std::copy_n(q0.coeffs().data(), 4, tangent.q0);
    std::copy_n(dphi.data(), 3, tangent.dphi);
    const VertexPoolBase& pool = *graph->PoolOf(tangent.vertex.type);
    tangent.UpdateBasis(pool.Data(pool.slots().IndexOf(tangent.vertex.slot)));
  }
  for (GaugeReference& reference : graph->gauge_references()) {
    orbit.Move(g, reference.anchor, reference.pose);
    reference.coordinate *= g.scale;
  }
  return {};
}

Status Move(Graph* graph, const OrbitMotion& g, const Orbit& orbit, const MoveOptions& options) {
  if (Status status = CheckMotion(g, orbit.group()); !status.ok()) return status;
  const std::vector<AnyEdge> obstacles = Obstacles(*graph, orbit, options);
  if (!obstacles.empty()) return RefuseEdges(obstacles);
  const Result<double> before = graph->Cost();
  if (!before.ok()) return before.status();

  const Snapshot snapshot = graph->GetSnapshot();
  const std::vector<GaugeReference> references = graph->gauge_references();
  PriorMover priors(graph, orbit);
  Status status = priors.Move(g, options.move_absolute_priors);
  if (status.ok()) status = MoveStates(g, orbit, graph);
  const Result<double> after = status.ok() ? graph->Cost() : Result<double>(status);
  // What u cannot tell: an edge that is blind to small motions only.
  const double tolerance = 1e-9 * before.value() + 1e-12;
  if (after.ok() && std::abs(after.value() - before.value()) <= tolerance) {
    if (priors.HasMovedMarginal()) graph->StructureChanged();
    return {};
  }
  priors.TakeBack();
  (void)graph->RestoreSnapshot(snapshot);
  graph->gauge_references() = references;
  if (!after.ok()) return after.status();
  return Refuse("the cost would go from " + std::to_string(before.value()) + " to " +
                std::to_string(after.value()));
}

}  // namespace

Status MoveAlongOrbit(Graph* graph, const OrbitMotion& g, const MoveOptions& options) {
  const Result<Orbit> orbit = Orbit::Of(*graph, options.group);
  return graph->Refused(orbit.ok() ? Move(graph, g, orbit.value(), options) : orbit.status());
}

namespace {

Status MoveIntoGauge(Graph* graph, const Gauge& gauge, const MoveOptions& options) {
  if (gauge.kind == Gauge::Kind::kFree) return {};
  if (gauge.kind == Gauge::Kind::kFixedPoses) {
    return {StatusCode::kInvalidArgument, "MoveToGauge: two whole poses are no gauge"};
  }
  const GaugeGroup group = gauge.group == GaugeGroup::kAuto ? options.group : gauge.group;
  const Result<Orbit> orbit = Orbit::Of(*graph, group);
  if (!orbit.ok()) return orbit.status();
  const Result<GaugeConstraint> constraint = GaugeConstraint::Of(gauge, orbit.value(), *graph);
  if (!constraint.ok()) return constraint.status();
  const auto state = [&](AnyVertex vertex) { return graph->Get(*vertex.As<VertexPose>()).pose; };
  const Pose anchor = state(constraint->reference.anchor);
  const Pose second = constraint->HasSecond() ? state(constraint->reference.second) : Pose();
  const OrbitMotion g = constraint->MotionTo(anchor.data, second.data);
  if (Status status = Move(graph, g, orbit.value(), options); !status.ok()) return status;
  Remember(constraint->reference, graph);
  return {};
}

}  // namespace

Status MoveToGauge(Graph* graph, const Gauge& gauge, const MoveOptions& options) {
  return graph->Refused(MoveIntoGauge(graph, gauge, options));
}

}  // namespace glissade
