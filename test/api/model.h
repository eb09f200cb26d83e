// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "glissade/glissade.h"

namespace glissade::test {

/// A graph as plain lists: what should exist, said without pools, slots and generations.
class Model {
 public:
  struct Vertex {
    AnyVertex handle;
    std::vector<double> state;
    Fix fix = Fix::kFree;
    bool eliminated = false;
    bool has_x_lin = false;
  };
  struct Edge {
    AnyEdge handle;
    std::vector<AnyVertex> vertices;
    bool is_prior = false;
  };

  std::vector<Vertex> vertices;  ///< in the order in which they were added
  std::vector<Edge> edges;
  bool refused = false;  ///< a call since the last acknowledgement

  [[nodiscard]] Vertex* Find(AnyVertex handle);
  [[nodiscard]] Edge* Find(AnyEdge handle);
  [[nodiscard]] bool Has(AnyVertex handle) { return Find(handle) != nullptr; }
  [[nodiscard]] bool Has(AnyEdge handle) { return Find(handle) != nullptr; }
  [[nodiscard]] bool IsUnderPrior(AnyVertex handle) const;
  /// Whether vertices may be joined by an edge: all here, all different, one eliminated at most.
  [[nodiscard]] bool CanJoin(const std::vector<AnyVertex>& handles);
  [[nodiscard]] bool HasEliminatedNeighbour(AnyVertex handle);

  void AddEdge(AnyEdge handle, std::vector<AnyVertex> on, bool is_prior);
  void Remove(AnyVertex handle);
  void Remove(AnyEdge handle);
  /// States after a call that may move them. Empty, or which vertex moved that must not have. Free
  /// is what is not fixed and has edges; a gauge prior pulls at a vertex without any too.
  enum class MayMove { kWhatIsFree, kWhatIsNotFixed, kAll };
  std::string TakeStates(const Graph& graph, MayMove may_move);
  /// After calls that may keep landmarks from elimination.
  void TakeElimination(const Graph& graph);

  /// Empty, or what differs.
  [[nodiscard]] std::string Compare(const Problem& problem);

 private:
  [[nodiscard]] std::string CompareVertices(const Problem& problem);
  [[nodiscard]] std::string CompareEdges(const Problem& problem);
  template <class E>
  [[nodiscard]] std::string CompareTyped(const Problem& problem);
  void DropOrphans();
};

/// What a refused call must leave as it was: states, charts, linearization points, edges, versions.
struct Record {
  explicit Record(const Problem& problem);
  /// Empty, or what differs.
  [[nodiscard]] std::string Compare(const Record& before) const;

  Snapshot snapshot;
  std::vector<AnyEdge> edges;
  std::uint64_t structure_version = 0, weights_version = 0;
};

}  // namespace glissade::test
