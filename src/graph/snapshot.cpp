// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/snapshot.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_set>

#include "glissade/graph/pools.h"
#include "glissade/lie/pose.h"
#include "glissade/lie/so3.h"

namespace glissade {

namespace {

Status Misfit(const std::string& what, AnyVertex vertex = {}) {
  return {StatusCode::kInvalidArgument, "RestoreSnapshot: " + what, vertex};
}

/// Whether Exp(dphi) R0 is the pose's rotation, up to what comes of many small steps.
bool IsChartOf(const FreeTangent& tangent, const double* pose) {
  const Vector3 dphi(tangent.dphi[0], tangent.dphi[1], tangent.dphi[2]);
  const Quaternion q = so3::ExpQuaternion(dphi) * Quaternion(tangent.q0);
  const Quaternion at(pose + 3);
  const double cosine = q.coeffs().dot(at.coeffs()) / (q.norm() * at.norm());
  return std::abs(std::abs(cosine) - 1.0) < 1e-9;
}

}  // namespace

Snapshot Graph::GetSnapshot() const {
  Snapshot snapshot;
  snapshot.vertices = Vertices();
  for (const AnyVertex& vertex : snapshot.vertices) {
    const VertexSite site = Locate(vertex);
    const double* data = site.pool->Data(site.index);
    snapshot.states.insert(snapshot.states.end(), data, data + site.pool->ops().ambient_dim);
  }
  snapshot.free_tangents = free_tangents_;
  for (const auto& pool : vertex_pools_) {
    for (int k = 0; k < pool->size(); ++k) {
      const double* x = pool->first_estimates().At(k);
      if (x == nullptr) continue;
      snapshot.first_estimate_vertices.push_back(pool->HandleAt(k));
      snapshot.first_estimates.insert(snapshot.first_estimates.end(), x,
                                      x + pool->ops().ambient_dim);
    }
  }
  return snapshot;
}

Status Graph::CheckStates(std::span<const AnyVertex> vertices, std::span<const double> states,
                          std::string_view what) const {
  std::size_t size = 0;
  std::unordered_set<AnyVertex> seen;
  for (const AnyVertex& vertex : vertices) {
    const VertexSite site = Locate(vertex);
    if (site.pool == nullptr) {
      return Misfit(std::string(what) + " of a vertex that is not in the graph", vertex);
    }
    if (!seen.insert(vertex).second) {
      return Misfit(ToString(vertex) + " has two " + std::string(what) + "s", vertex);
    }
    size += static_cast<std::size_t>(site.pool->ops().ambient_dim);
  }
  if (states.size() != size) {
    return Misfit(std::string(what) + "s: " + std::to_string(states.size()) +
                  " numbers instead of " + std::to_string(size));
  }
  const double* x = states.data();
  for (const AnyVertex& vertex : vertices) {
    const VertexOps& ops = Locate(vertex).pool->ops();
    if (Status status = ops.validate(x); !status.ok()) {
      return {status.code(),
              "RestoreSnapshot: " + std::string(what) + " of " + ToString(vertex) + ": " +
                  status.message(),
              vertex};
    }
    x += ops.ambient_dim;
  }
  return {};
}

// A snapshot is plain numbers that may come from anywhere.
Status Graph::CheckSnapshot(const Snapshot& snapshot) const {
  if (static_cast<int>(snapshot.vertices.size()) != NumVertices()) {
    return Misfit("vertices were added or removed since it was taken");
  }
  if (Status s = CheckStates(snapshot.vertices, snapshot.states, "state"); !s.ok()) return s;
  if (Status s = CheckStates(snapshot.first_estimate_vertices, snapshot.first_estimates,
                             "linearization point");
      !s.ok()) {
    return s;
  }
  std::unordered_set<AnyVertex> seen;
  for (const FreeTangent& tangent : snapshot.free_tangents) {
    if (!seen.insert(tangent.vertex).second) {
      return Misfit(ToString(tangent.vertex) + " has two charts", tangent.vertex);
    }
    Status status = ValidateQuaternion(tangent.q0, "chart");
    if (status.ok()) status = ValidateFinite(tangent.dphi, 3, "chart");
    if (!status.ok()) {
      return {status.code(), "RestoreSnapshot: " + status.message(), tangent.vertex};
    }
  }
  return {};
}

Status Graph::RestoreSnapshot(const Snapshot& snapshot) {
  if (Status status = CheckSnapshot(snapshot); !status.ok()) return Refused(std::move(status));
  RestoreFirstEstimates(snapshot);
  const double* from = snapshot.states.data();
  for (const AnyVertex& vertex : snapshot.vertices) {
    const VertexSite site = Locate(vertex);
    const int dim = site.pool->ops().ambient_dim;
    std::copy_n(from, dim, site.pool->Data(site.index));
    from += dim;
  }
  // Charts: those of the snapshot for vertices that are still held alike, fresh ones for the rest.
  // What follows from a chart (its basis, its dimensions) is computed, not believed.
  for (FreeTangent& tangent : free_tangents_) {
    DropGaugeReference(tangent.vertex);
    Reanchor(&tangent);
    if (tangent.fix != Fix::kPositionAndYaw) continue;
    const VertexSite site = Locate(tangent.vertex);
    const double* pose = site.pool->Data(site.index);
    for (const FreeTangent& old : snapshot.free_tangents) {
      if (old.vertex != tangent.vertex || old.fix != tangent.fix || !IsChartOf(old, pose)) continue;
      std::copy_n(old.q0, 4, tangent.q0);
      std::copy_n(old.dphi, 3, tangent.dphi);
      tangent.UpdateBasis(pose);
    }
  }
  return {};
}

void Graph::RestoreFirstEstimates(const Snapshot& snapshot) {
  const std::unordered_set<AnyVertex> kept(snapshot.first_estimate_vertices.begin(),
                                           snapshot.first_estimate_vertices.end());
  bool changed = false;
  for (const auto& pool : vertex_pools_) {
    for (int k = 0; k < pool->size() && !pool->first_estimates().empty(); ++k) {
      if (pool->first_estimates().At(k) == nullptr || kept.contains(pool->HandleAt(k))) continue;
      if (PriorOn(*pool, k)) continue;  // that has come since, and was linearized there
      pool->DropFirstEstimate(k);
      changed = true;
    }
  }
  const double* x = snapshot.first_estimates.data();
  for (const AnyVertex& vertex : snapshot.first_estimate_vertices) {
    const VertexSite site = Locate(vertex);
    changed |= site.pool->first_estimates().At(site.index) == nullptr;
    site.pool->SetFirstEstimate(site.index, x);
    x += site.pool->ops().ambient_dim;
  }
  if (changed) StructureChanged();
}

}  // namespace glissade
