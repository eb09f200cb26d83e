// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "api/model.h"
#include "api/nasty_values.h"

namespace glissade::test {

/// Random calls to up to three problems, clones and strangers of one another, each beside its
/// model: handles may be dead, null, made up, of another problem or of another type, numbers may be
/// anything. After each call the two must agree on whether it is refused; a refused one must leave
/// no trace, and no number that is not finite may come out of any.
class ApiWalk {
 public:
  explicit ApiWalk(std::uint64_t seed);

  /// Empty, or what went wrong after which calls.
  std::string Run(int num_calls);

 private:
  struct World {
    Problem problem;
    Model model;
  };
  enum class Expect { kRefused, kAccepted, kEither };

  void Call();
  /// Keeps the problem as it is before a call.
  void Begin();
  /// Compares outcome and expectation; true if the call was accepted.
  bool End(const Status& status, Expect expected, bool changes = true);
  static Expect AcceptedIf(bool condition) {
    return condition ? Expect::kAccepted : Expect::kRefused;
  }
  void Fail(std::string what);
  void Check(bool condition, const char* what);

  [[nodiscard]] AnyVertex PickVertex();
  [[nodiscard]] AnyEdge PickEdge();
  template <VertexType V>
  [[nodiscard]] VertexHandle<V> PickVertexOf();
  template <EdgeType E>
  [[nodiscard]] EdgeHandle<E> PickEdgeOf();
  [[nodiscard]] std::vector<AnyVertex> PickVertices(int most);
  [[nodiscard]] Gauge PickGauge();

  void AddSomeVertex();
  template <VertexType V>
  void AddVertex();
  template <VertexType V>
  void AddVertices();
  void AddSomeEdge();
  template <EdgeType E>
  void AddEdge(const E& edge, const EdgeVertexHandles<E>& on);
  void AddEdges();
  void AddPrior();
  void RemoveVertex();
  void RemoveEdge();
  void SetSomeValue();
  template <VertexType V>
  void SetValue();
  void SetFixed();
  void SetEliminated();
  void SetFirstEstimate();
  void SetWeight();
  template <EdgeType E>
  void SetInformation();
  void SetLoss();
  void Marginalize();
  void ComputePrior();
  void CloneOrMove();
  void TakeSnapshot();
  void RestoreSnapshot();
  void Solve();
  void Step();
  void Covariance();
  void Gauges();
  void Queries();

  void Entered(AnyVertex handle, const double* state, int dim, bool eliminated);

  NastyValues random_;
  std::deque<World> worlds_;
  World* now_ = nullptr;
  std::vector<AnyVertex> vertices_;  ///< all handles there ever were, of all worlds
  std::vector<AnyEdge> edges_;
  std::vector<Snapshot> snapshots_;
  std::vector<std::string> log_;
  std::string failure_;
  std::optional<Record> before_;
};

template <VertexType V>
VertexHandle<V> ApiWalk::PickVertexOf() {
  for (int attempt = 0; attempt < 12; ++attempt) {
    if (const auto typed = PickVertex().As<V>()) return *typed;
  }
  return {};
}

template <EdgeType E>
EdgeHandle<E> ApiWalk::PickEdgeOf() {
  for (int attempt = 0; attempt < 12; ++attempt) {
    if (const auto typed = PickEdge().As<E>()) return *typed;
  }
  return {};
}

}  // namespace glissade::test
