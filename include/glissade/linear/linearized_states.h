// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "glissade/graph/pools.h"

namespace glissade {

/// The states that a linearization was made at. A solve often ends one accepted step after it last
/// linearized, and whoever looks at H then (CheckNullspace) needs the states that belong to it.
class LinearizedStates {
 public:
  /// Copies all states; allocates nothing once sized.
  void Keep(const Graph& graph) {
    const Graph::VertexPools& pools = graph.vertex_pools();
    states_.resize(pools.size());
    for (std::size_t p = 0; p < pools.size(); ++p) {
      const VertexPoolBase& pool = *pools[p];
      const auto dim = static_cast<std::size_t>(pool.ops().ambient_dim);
      states_[p].resize(static_cast<std::size_t>(pool.size()) * dim);
      double* to = states_[p].data();
      for (int k = 0; k < pool.size(); ++k, to += dim) {
        const double* from = pool.Data(k);
        for (std::size_t i = 0; i < dim; ++i)
          to[i] = from[i];
      }
    }
  }
  /// State of the vertex at a dense index of a pool (positions as at the last Keep()).
  [[nodiscard]] const double* State(const VertexPoolBase& pool, int index) const {
    return states_[static_cast<std::size_t>(pool.id())].data() +
           static_cast<std::size_t>(index) * static_cast<std::size_t>(pool.ops().ambient_dim);
  }

 private:
  std::vector<std::vector<double>> states_;
};

}  // namespace glissade
