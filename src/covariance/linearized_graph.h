// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <unordered_map>
#include <vector>

#include "glissade/gauge/gauge_guard.h"
#include "glissade/linear/normal_equations.h"
#include "glissade/structure/structure.h"

namespace glissade {

/// H of a graph in a gauge, with what is needed to look blocks up after the graph has gone on.
struct LinearizedGraph {
  /// Where a vertex is in the system.
  struct Place {
    int pose = -1;      ///< pose block, or
    int landmark = -1;  ///< landmark block, or neither: fixed
    int dim = 0;
    bool unconnected = false;  ///< free, but without edges: not in the system
    std::vector<double> state;
  };

  Structure structure;
  NormalEquations equations;
  std::optional<Hessian> hessian;  ///< after Linearize
  ThreadPool threads;
  std::vector<FreeTangent> tangents;
  std::vector<GaugeReference> references;
  std::vector<AnyVertex> vertices;  ///< all, in the graph's order

  /// At the present values. No landmarks in groups, which keep no W.
  Status Linearize(Graph* graph, const Gauge& gauge, int num_threads);
  /// After Linearize. The reduced system, undamped.
  Status Eliminate(const Graph& graph);

  /// Null for a vertex that was not in the graph.
  [[nodiscard]] const Place* Find(AnyVertex vertex) const;
  template <class Block>
  [[nodiscard]] AnyVertex Handle(const Block& block) const {
    return handles_[static_cast<std::size_t>(block.pool)][static_cast<std::size_t>(block.index)];
  }

 private:
  void ListPlaces(const Graph& graph);

  std::vector<std::vector<AnyVertex>> handles_;  // by pool and index
  std::vector<std::vector<Place>> places_;
  std::unordered_map<const TypeInfo*, std::unordered_map<std::uint32_t, std::size_t>> index_;
};

}  // namespace glissade
