// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What a graph holds fixed, and which of its vertices are eliminated.

#include "glissade/graph/pools.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"

namespace glissade {

void Graph::DropFreeTangent(AnyVertex vertex) {
  std::erase_if(free_tangents_, [&](const FreeTangent& t) { return t.vertex == vertex; });
}

void Graph::Reanchor(AnyVertex vertex) {
  DropGaugeReference(vertex);
  for (FreeTangent& tangent : free_tangents_) {
    if (tangent.vertex != vertex) continue;
    const VertexSite site = Locate(vertex);
    const double* state = site.pool->Data(site.index);
    if (tangent.fix == Fix::kCoordinate) {
      tangent.UpdateBasis(state);
    } else {
      tangent = FreeTangent::At(vertex, tangent.fix, state);
    }
  }
}

Status Graph::CheckFixed(const VertexSite& site, AnyVertex vertex, Fix fix) const {
  if (site.pool == nullptr) return UnknownHandle(vertex);
  switch (fix) {
    case Fix::kFree:
    case Fix::kWhole:
      return {};
    case Fix::kBiases:
      if (vertex.type == &kTypeInfo<VertexSpeedBias>) return {};
      return {StatusCode::kInvalidArgument,
              "SetFixed: only a VertexSpeedBias has biases, not " + ToString(vertex), vertex};
    case Fix::kPosition:
    case Fix::kPositionAndYaw:
      if (vertex.type == &kTypeInfo<VertexPose>) return {};
      return {StatusCode::kInvalidArgument,
              "SetFixed: only a VertexPose can be fixed in part, not " + ToString(vertex), vertex};
    case Fix::kCoordinate:
      return {StatusCode::kInvalidArgument, "SetFixed: kCoordinate is for gauges", vertex};
  }
  return {StatusCode::kInvalidArgument,
          "SetFixed: " + std::to_string(static_cast<int>(fix)) + " is no Fix", vertex};
}

Status Graph::SetFixed(AnyVertex vertex, Fix fix) {
  const VertexSite site = Locate(vertex);
  if (Status status = CheckFixed(site, vertex, fix); !status.ok()) {
    return Refused(std::move(status));
  }
  const bool partial = fix != Fix::kFree && fix != Fix::kWhole;
  if (site.pool->fix(site.index) == fix && !partial) return {};
  DropFreeTangent(vertex);
  if (partial) {
    free_tangents_.push_back(FreeTangent::At(vertex, fix, site.pool->Data(site.index)));
  }
  site.pool->set_fix(site.index, fix);
  StructureChanged();
  return {};
}

Fix Graph::GetFixed(AnyVertex vertex) const {
  const VertexSite site = Locate(vertex);
  return site.pool == nullptr ? Fix::kFree : site.pool->fix(site.index);
}

Status Graph::CheckEliminated(const VertexSite& site, AnyVertex vertex) const {
  if (site.pool->ops().tangent_dim > 4) {
    return {StatusCode::kInvalidArgument,
            "SetEliminated: " + ToString(vertex) + " has more than 4 tangent dimensions", vertex};
  }
  if (site.pool->eliminated(site.index)) return {};
  for (const auto& pool : edge_pools_) {
    AnyEdge joins;
    AnyVertex other;
    pool->ForEachEdgeAt(*site.pool, vertex.slot, [&](int edge) {  // the oldest comes last
      for (int i = pool->arity(edge); i-- > 0;) {
        const VertexPoolBase& vertices = *pool->vertex_pool(edge, i);
        if (!vertices.eliminated(vertices.slots().IndexOf(pool->vertex_slot(edge, i)))) continue;
        joins = pool->HandleAt(edge);
        other = pool->VertexOf(edge, i);
      }
    });
    if (!joins) continue;
    return {StatusCode::kEliminatedPair,
            "SetEliminated: " + ToString(joins) + " joins " + ToString(vertex) +
                " to the eliminated " + ToString(other),
            joins};
  }
  return {};
}

Status Graph::SetEliminated(AnyVertex vertex, bool eliminated) {
  const VertexSite site = Locate(vertex);
  if (site.pool == nullptr) return Refused(UnknownHandle(vertex));
  if (eliminated) {
    if (Status status = CheckEliminated(site, vertex); !status.ok()) {
      return Refused(std::move(status));
    }
  }
  if (site.pool->eliminated(site.index) == eliminated) return {};
  site.pool->set_eliminated(site.index, eliminated);
  StructureChanged();
  return {};
}

}  // namespace glissade
