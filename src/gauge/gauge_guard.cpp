// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/gauge/gauge_guard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>

#include "glissade/gauge/gauge_prior.h"
#include "glissade/graph/pools.h"
#include "glissade/lie/pose.h"

namespace glissade {

namespace {

/// What Fixed and FixedPoses hold: at most two vertices, so that a solve allocates nothing.
class Holds {
 public:
  void Add(const FreeTangent& hold) { holds_[static_cast<std::size_t>(count_++)] = hold; }
  void AddWhole(AnyVertex vertex) {
    FreeTangent whole;
    whole.vertex = vertex;
    whole.fix = Fix::kWhole;
    Add(whole);
  }
  operator std::span<const FreeTangent>() const {  // NOLINT: implicit, it is one
    return {holds_.data(), static_cast<std::size_t>(count_)};
  }

 private:
  std::array<FreeTangent, 2> holds_;
  int count_ = 0;
};

/// What Fixed holds, beside what the graph holds already.
Holds HoldsOf(const GaugeConstraint& constraint, const Graph& graph) {
  const GaugeReference& reference = constraint.reference;
  const auto state = [&](AnyVertex vertex) {
    const VertexPoolBase* pool = graph.PoolOf(vertex.type);
    return pool->Data(pool->slots().IndexOf(vertex.slot));
  };
  const double* anchor = state(reference.anchor);
  Holds holds;
  const Fix own = graph.GetFixed(reference.anchor);
  if (constraint.group == GaugeGroup::kVisualInertial) {
    if (own != Fix::kWhole && own != Fix::kPositionAndYaw) {
      holds.Add(FreeTangent::InChart(reference.anchor, reference.pose + 3, anchor));
    }
    return holds;
  }
  if (own != Fix::kWhole) holds.AddWhole(reference.anchor);
  if (!constraint.HasSecond() || graph.GetFixed(reference.second) != Fix::kFree) return holds;
  const Vector3 normal = RotationMatrix(anchor + 3).col(reference.axis);
  holds.Add(FreeTangent::OnPlane(reference.second, normal.data(), constraint.lever,
                                 state(reference.second)));
  return holds;
}

}  // namespace

Status GaugeGuard::Begin(const Gauge& gauge, Graph* graph) {
  End();
  if (gauge.kind == Gauge::Kind::kFree) return {};
  if (gauge.kind == Gauge::Kind::kFixedPoses) {
    Holds holds;
    for (const AnyVertex vertex : {AnyVertex(gauge.anchor), AnyVertex(gauge.second)}) {
      if (!graph->Contains(vertex)) {
        return internal::About(graph->UnknownHandle(vertex), "gauge");
      }
      if (graph->GetFixed(vertex) != Fix::kWhole) holds.AddWhole(vertex);
    }
    return Hold(graph, graph->BeginHold(holds));
  }
  if (gauge.kind != Gauge::Kind::kFixed && gauge.kind != Gauge::Kind::kPrior) {
    return {StatusCode::kInvalidArgument, "gauge: kind is no Gauge::Kind"};
  }
  const Result<Orbit> orbit = Orbit::Of(*graph, gauge.group);
  if (!orbit.ok()) return orbit.status();
  const Result<GaugeConstraint> constraint = GaugeConstraint::Of(gauge, orbit.value(), *graph);
  if (!constraint.ok()) return constraint.status();
  if (gauge.kind == Gauge::Kind::kFixed) {
    const Status status = Hold(graph, graph->BeginHold(HoldsOf(constraint.value(), *graph)));
    if (status.ok()) Remember(constraint->reference, graph);
    return status;
  }
  if (!(gauge.weight > 0.0) || !std::isfinite(gauge.weight)) {
    return {StatusCode::kInvalidArgument, "gauge: the prior's weight must be positive"};
  }
  const AnyVertex vertices[] = {gauge.anchor, constraint->reference.second};
  const Status status =
      Hold(graph,
           graph->BeginHold({}, std::make_unique<EdgeGaugePrior>(constraint.value(), gauge.weight),
                            std::span(vertices, constraint->HasSecond() ? 2 : 1)));
  if (status.ok()) Remember(constraint->reference, graph);
  return status;
}

Status GaugeGuard::Hold(Graph* graph, Status status) {
  if (status.ok()) graph_ = graph;
  return status;
}

void GaugeGuard::End() noexcept {
  if (graph_ != nullptr) graph_->EndHold();
  graph_ = nullptr;
}

Status EdgeGaugePrior::CheckVertices(std::span<const VertexOps* const> vertices) const {
  const std::size_t expected = constraint_.HasSecond() ? 2 : 1;
  const bool poses = std::all_of(vertices.begin(), vertices.end(), [](const VertexOps* ops) {
    return ops->type == &kTypeInfo<VertexPose>;
  });
  if (vertices.size() == expected && poses) return {};
  return {StatusCode::kInvalidArgument,
          "EdgeGaugePrior: the anchor's pose is needed, and the "
          "second one where the scale is open"};
}

bool EdgeGaugePrior::Evaluate(std::span<const VertexRef> vertices, double* residual,
                              double* const* jacobians) const {
  const auto block = [&](std::size_t i) {
    return jacobians != nullptr && i < vertices.size() ? jacobians[i] : nullptr;
  };
  const double* second = vertices.size() > 1 ? vertices[1].data : nullptr;
  constraint_.Evaluate(vertices[0].data, second, residual, block(0), block(1));
  const double scale = std::sqrt(weight_);
  const int n = constraint_.dim();
  for (int k = 0; k < n; ++k)
    residual[k] *= scale;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (int k = 0; block(i) != nullptr && k < 6 * n; ++k)
      block(i)[k] *= scale;
  }
  return true;
}

}  // namespace glissade
