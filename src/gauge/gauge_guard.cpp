// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/gauge/gauge_guard.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "glissade/gauge/gauge_prior.h"
#include "glissade/lie/pose.h"

namespace glissade {

namespace {

/// What Fixed holds, beside what the graph holds already.
std::vector<FreeTangent> HoldsOf(const GaugeConstraint& constraint, const Graph& graph) {
  const GaugeReference& reference = constraint.reference;
  const auto state = [&](AnyVertex vertex) { return graph.Get(*vertex.As<VertexPose>()).pose; };
  const Pose anchor = state(reference.anchor);
  std::vector<FreeTangent> holds;
  const Fix own = graph.GetFixed(reference.anchor);
  FreeTangent whole;
  whole.vertex = reference.anchor;
  whole.fix = Fix::kWhole;
  if (constraint.group == GaugeGroup::kVisualInertial) {
    if (own != Fix::kWhole && own != Fix::kPositionAndYaw) {
      holds.push_back(FreeTangent::InChart(reference.anchor, reference.pose + 3, anchor.data));
    }
    return holds;
  }
  if (own != Fix::kWhole) holds.push_back(whole);
  if (!constraint.HasSecond() || graph.GetFixed(reference.second) != Fix::kFree) return holds;
  const Vector3 normal = anchor.R().col(reference.axis);
  holds.push_back(FreeTangent::OnPlane(reference.second, normal.data(), constraint.lever,
                                       state(reference.second).data));
  return holds;
}

}  // namespace

Status GaugeGuard::Begin(const Gauge& gauge, Graph* graph) {
  End();
  if (gauge.kind == Gauge::Kind::kFree) return {};
  if (gauge.kind == Gauge::Kind::kFixedPoses) {
    std::vector<FreeTangent> holds;
    for (const AnyVertex vertex : {AnyVertex(gauge.anchor), AnyVertex(gauge.second)}) {
      if (!graph->Contains(vertex)) {
        return internal::About(graph->UnknownHandle(vertex), "gauge");
      }
      if (graph->GetFixed(vertex) == Fix::kWhole) continue;
      FreeTangent whole;
      whole.vertex = vertex;
      whole.fix = Fix::kWhole;
      holds.push_back(whole);
    }
    graph->BeginHold(holds);
    graph_ = graph;
    return {};
  }
  const Result<Orbit> orbit = Orbit::Of(*graph, gauge.group);
  if (!orbit.ok()) return orbit.status();
  const Result<GaugeConstraint> constraint = GaugeConstraint::Of(gauge, orbit.value(), *graph);
  if (!constraint.ok()) return constraint.status();
  if (gauge.kind == Gauge::Kind::kFixed) {
    Remember(constraint->reference, graph);
    graph->BeginHold(HoldsOf(constraint.value(), *graph));
    graph_ = graph;
    return {};
  }
  if (!(gauge.weight > 0.0) || !std::isfinite(gauge.weight)) {
    return {StatusCode::kInvalidArgument, "gauge: the prior's weight must be positive"};
  }
  std::vector<AnyVertex> vertices{gauge.anchor};
  if (constraint->HasSecond()) vertices.push_back(constraint->reference.second);
  const auto added =
      graph->AddEdge(std::make_unique<EdgeGaugePrior>(constraint.value(), gauge.weight), vertices);
  if (!added.ok()) return added.status();
  Remember(constraint->reference, graph);
  prior_ = added.value();
  graph_ = graph;
  return {};
}

void GaugeGuard::End() {
  if (graph_ == nullptr) return;
  if (graph_->IsHolding()) graph_->EndHold();
  if (graph_->Contains(AnyEdge(prior_))) (void)graph_->RemoveEdge(prior_);
  prior_ = {};
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
