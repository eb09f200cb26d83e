// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/graph/graph.h"

namespace glissade {

/// Sees whether an iteration callback has changed the graph that is being solved: plans and
/// pointers into it would then be void, or H, b and the cost would be of other values.
class GraphWatch {
 public:
  /// states: storage that is kept from one solve to the next.
  explicit GraphWatch(std::vector<double>* states) : states_(*states) {}

  void Keep(const Graph& graph);
  /// What is not as it was, in words; null where all is.
  [[nodiscard]] const char* FindChange(const Graph& graph) const;

 private:
  std::vector<double>& states_;
  std::uint64_t identity_ = 0, structure_ = 0, weights_ = 0;
};

/// The graph at a trial point: back to where it was unless it is kept, also where a user's code
/// throws.
class TrialStates {
 public:
  explicit TrialStates(Graph* graph) : graph_(graph) { graph->SaveStates(); }
  TrialStates(const TrialStates&) = delete;
  TrialStates& operator=(const TrialStates&) = delete;
  ~TrialStates() {
    if (graph_ != nullptr) graph_->RestoreStates();
  }
  void Keep() { graph_ = nullptr; }

 private:
  Graph* graph_;
};

}  // namespace glissade
