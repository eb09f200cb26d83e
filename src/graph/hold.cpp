// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/hold.h"

#include <algorithm>

#include "glissade/graph/graph.h"

namespace glissade {

void Graph::BeginHold(std::span<const FreeTangent> holds) {
  if (hold_.active) EndHold();
  const auto what = [](const FreeTangent& hold) { return std::pair(hold.vertex, hold.fix); };
  const bool as_before =
      std::equal(holds.begin(), holds.end(), hold_.held.begin(), hold_.held.end(),
                 [&](const FreeTangent& hold, const auto& old) { return what(hold) == old; });
  if (!as_before || hold_.identity == 0) {
    hold_.held.clear();
    for (const FreeTangent& hold : holds)
      hold_.held.push_back(what(hold));
    hold_.identity = Graph().identity_;  // one that no graph has
  }
  hold_.before.clear();
  hold_.replaced.clear();
  hold_.num_own_tangents = free_tangents_.size();
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
}

void Graph::EndHold() {
  if (!hold_.active) return;
  // Backwards: where a vertex was named twice, the first entry is the graph's own.
  for (std::size_t k = hold_.before.size(); k-- > 0;) {
    const auto& [vertex, fix] = hold_.before[k];
    const VertexSite site = Locate(vertex);
    if (site.pool != nullptr) site.pool->set_fix(site.index, fix);
  }
  free_tangents_.resize(hold_.num_own_tangents);
  for (std::size_t k = hold_.replaced.size(); k-- > 0;)
    free_tangents_[hold_.replaced[k].first] = hold_.replaced[k].second;
  // What was saved on the way belongs to the hold.
  saved_free_tangents_ = free_tangents_;
  std::swap(identity_, hold_.identity);
  hold_.active = false;
}

void Graph::DropGaugeReference(AnyVertex vertex) {
  std::erase_if(gauge_references_,
                [&](const GaugeReference& reference) { return reference.anchor == vertex; });
}

}  // namespace glissade
