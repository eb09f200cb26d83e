// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Observations that were added twice.

#include <algorithm>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/structure/structure.h"

namespace glissade {

using internal::Index;

Status Structure::FindDuplicates(const Graph& graph) {
  for (std::size_t p = 0; p < num_pools_; ++p) {
    const EdgePoolBase& pool = *graph.edge_pools()[p];
    if (!pool.IsObservation() || pool.size() < 2) continue;
    const FlatEdges& edges = flat_[p];
    if (edges.arity == 0) continue;  // dynamic edges are not observations
    const int arity = edges.arity;
    std::size_t size = 64;
    while (size < 2 * Index(pool.size()))
      size *= 2;
    duplicate_table_.assign(size, {-1, -1});
    for (int edge = 0; edge < pool.size(); ++edge) {
      const std::int32_t* a = edges.index.data() + edges.Begin(edge);
      std::uint64_t hash = 0;
      for (int i = 0; i < arity; ++i) {
        hash = (hash ^ static_cast<std::uint32_t>(a[i])) * 0x9E3779B97F4A7C15ull;
        hash ^= hash >> 29;
      }
      std::size_t slot = static_cast<std::size_t>(hash >> 20) & (size - 1);
      for (; duplicate_table_[slot].edge >= 0; slot = (slot + 1) & (size - 1)) {
        const int other = duplicate_table_[slot].edge;
        const std::int32_t* b = edges.index.data() + edges.Begin(other);
        if (std::equal(a, a + arity, b) && pool.IsDuplicate(other, edge)) {
          const AnyEdge first = pool.HandleAt(other), second = pool.HandleAt(edge);
          return {
              StatusCode::kDuplicate,
              "the same observation twice: edges " + ToString(first) + " and " + ToString(second),
              first, second};
        }
      }
      duplicate_table_[slot] = {static_cast<std::int32_t>(p), edge};
    }
  }
  return {};
}

}  // namespace glissade
