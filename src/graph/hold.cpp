// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/hold.h"

#include <algorithm>

#include "glissade/graph/pools.h"

namespace glissade {

Status Graph::BeginHold(std::span<const FreeTangent> holds, std::unique_ptr<DynamicEdge> edge,
                        std::span<const AnyVertex> edge_vertices) {
  EndHold();
  const auto what = [](const FreeTangent& hold) { return std::pair(hold.vertex, hold.fix); };
  const int rows = edge != nullptr ? edge->ResidualDim() : 0;
  const bool as_before =
      std::equal(holds.begin(), holds.end(), hold_.held.begin(), hold_.held.end(),
                 [&](const FreeTangent& hold, const auto& old) { return what(hold) == old; }) &&
      rows == hold_.edge_rows &&
      std::equal(edge_vertices.begin(), edge_vertices.end(), hold_.edge_vertices.begin(),
                 hold_.edge_vertices.end());
  if (!as_before || hold_.identity == 0) {
    hold_.held.clear();
    for (const FreeTangent& hold : holds)
      hold_.held.push_back(what(hold));
    hold_.edge_vertices.assign(edge_vertices.begin(), edge_vertices.end());
    hold_.edge_rows = rows;
    hold_.identity = NewIdentity();  // one that no graph has
  }
  // All that can fail or run out of memory, also what EndHold() needs, comes before the first
  // change.
  hold_.before.clear();
  hold_.before.reserve(holds.size());
  hold_.replaced.clear();
  hold_.replaced.reserve(holds.size());
  hold_.num_own_tangents = free_tangents_.size();
  free_tangents_.reserve(free_tangents_.size() + holds.size());
  saved_free_tangents_.reserve(free_tangents_.size() + holds.size());
  if (edge != nullptr) {
    // Refusing a gauge is no refused call of the graph's.
    if (Status s = CheckDynamicEdge(edge.get(), edge_vertices, {}); !s.ok()) return s;
    const std::uint64_t version = structure_version_;
    const auto added = AddEdge(std::move(edge), edge_vertices);
    if (!added.ok()) return added.status();
    structure_version_ = version;
    hold_.edge = added.value();
  }
  for (const FreeTangent& hold : holds) {
    const VertexSite site = Locate(hold.vertex);
    if (site.pool == nullptr) continue;
    hold_.before.emplace_back(hold.vertex, site.pool->fix(site.index));
    site.pool->set_fix(site.index, hold.fix);
    if (hold.fix == Fix::kWhole) continue;
    const auto own =
        std::find_if(free_tangents_.begin(), free_tangents_.end(),
                     [&](const FreeTangent& tangent) { return tangent.vertex == hold.vertex; });
    if (own == free_tangents_.end()) {
      free_tangents_.push_back(hold);
    } else {
      hold_.replaced.emplace_back(own - free_tangents_.begin(), *own);
      *own = hold;
    }
  }
  std::swap(identity_, hold_.identity);
  hold_.active = true;
  return {};
}

void Graph::EndHold() noexcept {
  if (!hold_.active) return;
  // Backwards: where a vertex was named twice, the first entry is the graph's own.
  for (std::size_t k = hold_.before.size(); k-- > 0;) {
    const auto& [vertex, fix] = hold_.before[k];
    const VertexSite site = Locate(vertex);
    if (site.pool != nullptr) site.pool->set_fix(site.index, fix);
  }
  free_tangents_.resize(std::min(hold_.num_own_tangents, free_tangents_.size()));
  for (std::size_t k = hold_.replaced.size(); k-- > 0;) {
    const auto& [index, tangent] = hold_.replaced[k];
    if (index < free_tangents_.size()) free_tangents_[index] = tangent;
  }
  // What was saved on the way belongs to the hold.
  saved_free_tangents_ = free_tangents_;
  if (const EdgeSite site = Locate(hold_.edge); site.pool != nullptr) {
    auto* pool = static_cast<DynamicEdgePool*>(site.pool);
    if (!pool->TakeBack(*hold_.edge.As<DynamicEdge>())) {
      pool->Remove(hold_.edge.slot);  // somebody has added edges meanwhile
      StructureChanged();
    }
  }
  hold_.edge = {};
  std::swap(identity_, hold_.identity);
  hold_.active = false;
}

void Graph::DropGaugeReference(AnyVertex vertex) {
  std::erase_if(gauge_references_,
                [&](const GaugeReference& reference) { return reference.anchor == vertex; });
}

}  // namespace glissade
