// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Ids of vertices came from one counter for all problems, and the destructor of any problem set it
// back to 0: what was added next got ids that were taken.
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "glissade/problem/problem.h"
#include "glissade/vertices/inverse_depth.h"

namespace glissade {
namespace {

using Id = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;

/// The library's Problem, with values looked up by id.
class Ours {
 public:
  Id Add(double value) {
    const auto handle = problem_.AddVertex(VertexInverseDepth{value}).value();
    return {handle.slot, handle.generation, handle.graph};
  }
  [[nodiscard]] std::optional<double> Find(Id id) const {
    const auto [slot, generation, graph] = id;
    const auto* v = problem_.Find(VertexHandle<VertexInverseDepth>{slot, generation, graph});
    return v != nullptr ? std::optional(v->rho) : std::nullopt;
  }

 private:
  Problem problem_;
};

/// As in the course: a map by id, ids from a counter that all share and each destructor resets.
class WithGlobalCounter {
 public:
  ~WithGlobalCounter() { next_id_ = 0; }
  Id Add(double value) {
    const Id id{next_id_++, 0, 0};
    vertices_.insert({id, value});  // an id that is taken: the new vertex is lost
    return id;
  }
  [[nodiscard]] std::optional<double> Find(Id id) const {
    const auto at = vertices_.find(id);
    return at != vertices_.end() ? std::optional(at->second) : std::nullopt;
  }

 private:
  static inline std::uint32_t next_id_ = 0;
  std::map<Id, double> vertices_;
};

/// The check: what is added to one problem is found there under an id of its own, whatever becomes
/// of other problems.
template <class P>
bool ProblemsAreIndependent() {
  P first;
  std::vector<std::pair<Id, double>> added;
  const auto add = [&](double value) { added.emplace_back(first.Add(value), value); };
  for (int k = 0; k < 3; ++k)
    add(0.1 * k);
  {
    P other;
    other.Add(7.0);
    other.Add(8.0);
    add(0.5);
  }
  for (int k = 0; k < 3; ++k)
    add(1.0 + k);
  std::set<Id> ids;
  for (const auto& [id, value] : added) {
    ids.insert(id);
    if (first.Find(id) != value) return false;
  }
  return ids.size() == added.size();
}

TEST(GlobalIds, DestroyingOneProblemDoesNotTouchAnother) {
  EXPECT_TRUE(ProblemsAreIndependent<Ours>());
  EXPECT_FALSE(ProblemsAreIndependent<WithGlobalCounter>());
}

}  // namespace
}  // namespace glissade
