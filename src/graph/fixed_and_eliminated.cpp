// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What a graph holds fixed, and which of its vertices are eliminated.

#include "glissade/graph/pools.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"

namespace glissade {

namespace {

/// Whether a vertex held so has a FreeTangent.
bool IsPartial(Fix fix) {
  return fix != Fix::kFree && fix != Fix::kWhole;
}

}  // namespace

void Graph::DropFreeTangent(AnyVertex vertex) {
  std::erase_if(free_tangents_, [&](const FreeTangent& t) { return t.vertex == vertex; });
}

void Graph::Reanchor(AnyVertex vertex) {
  DropGaugeReference(vertex);
  if (!IsPartial(GetFixed(vertex)) && !IsHolding()) return;
  for (FreeTangent& tangent : free_tangents_) {
    if (tangent.vertex == vertex) Reanchor(&tangent);
  }
}

void Graph::Reanchor(FreeTangent* tangent) const {
  if (tangent->fix == Fix::kNumbers) return;  // whatever the state
  const VertexSite site = Locate(tangent->vertex);
  const double* state = site.pool->Data(site.index);
  if (tangent->fix == Fix::kCoordinate) {
    tangent->UpdateBasis(state);
  } else {
    *tangent = FreeTangent::At(tangent->vertex, tangent->fix, state);
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
    case Fix::kNumbers:
      return {StatusCode::kInvalidArgument, "SetFixed: SetFixedNumbers says which", vertex};
  }
  return {StatusCode::kInvalidArgument,
          "SetFixed: " + std::to_string(static_cast<int>(fix)) + " is no Fix", vertex};
}

Status Graph::SetFixed(AnyVertex vertex, Fix fix) {
  const VertexSite site = Locate(vertex);
  if (Status status = CheckFixed(site, vertex, fix); !status.ok()) {
    return Refused(std::move(status));
  }
  if (!IsPartial(fix)) {
    SetFixedTo(site, vertex, fix, nullptr);
  } else {
    const FreeTangent tangent = FreeTangent::At(vertex, fix, site.pool->Data(site.index));
    SetFixedTo(site, vertex, fix, &tangent);
  }
  return {};
}

void Graph::SetFixedTo(const VertexSite& site, AnyVertex vertex, Fix fix,
                       const FreeTangent* tangent) {
  const Fix old = site.pool->fix(site.index);
  if (old == fix && tangent == nullptr) return;
  if (IsPartial(old) || IsHolding()) DropFreeTangent(vertex);
  if (tangent != nullptr) free_tangents_.push_back(*tangent);
  site.pool->set_fix(site.index, fix);
  StructureChanged();
}

Status Graph::SetFixedNumbers(AnyVertex vertex, std::uint32_t held) {
  const VertexSite site = Locate(vertex);
  if (site.pool == nullptr) return Refused(UnknownHandle(vertex));
  const VertexOps& ops = site.pool->ops();
  const auto refuse = [&](const std::string& why) {
    return Refused(
        {StatusCode::kInvalidArgument, "SetFixedNumbers: " + ToString(vertex) + why, vertex});
  };
  if (!ops.additive || ops.tangent_dim > FreeTangent::kMaxTangentDim) {
    return refuse(" is not additive, of up to 9 numbers");
  }
  if (site.pool->eliminated(site.index)) return refuse(" is eliminated");
  const std::uint32_t all = (1u << ops.tangent_dim) - 1u;
  if ((held & ~all) != 0) return refuse(" has fewer numbers");
  if (held == 0 || held == all) {
    SetFixedTo(site, vertex, held == 0 ? Fix::kFree : Fix::kWhole, nullptr);
    return {};
  }
  const FreeTangent tangent = FreeTangent::Numbers(vertex, ops.tangent_dim, held);
  SetFixedTo(site, vertex, Fix::kNumbers, &tangent);
  return {};
}

std::uint32_t Graph::FixedNumbers(AnyVertex vertex) const {
  if (GetFixed(vertex) != Fix::kNumbers) return 0;
  for (const FreeTangent& tangent : free_tangents_) {
    if (tangent.vertex == vertex) return tangent.held;
  }
  return 0;
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
  if (IsPartial(site.pool->fix(site.index))) {
    return {StatusCode::kInvalidArgument, "SetEliminated: " + ToString(vertex) + " is held in part",
            vertex};
  }
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
