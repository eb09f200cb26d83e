// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

namespace glissade {

/// How the edges of one type are evaluated, by their number: all of them, those whose vertices are
/// all fixed too.
struct EdgeEvaluation {
  std::string_view type;  ///< its name
  /// As many at once as a register has room for (base/pack.h). With first estimates away from the
  /// states, Jacobians of edges with FirstEstimateRule::kWhole are taken one by one all the same.
  int in_packs = 0;
  int one_by_one = 0;
  /// Of both: on landmarks that are eliminated in groups, poses as twists
  /// (structure/landmark_plan.h).
  int as_twists = 0;
  /// That edges on landmarks take up, in packs or not: edges on the same vertices but for the
  /// landmark fill blocks of 8, the last of which is not full.
  std::int64_t lanes = 0;
  /// Packs whose lanes disagreed about a condition, so that their edges were evaluated once more,
  /// one by one; over all iterations. Select() instead of `if` spares that.
  std::int64_t packs_redone = 0;
};

}  // namespace glissade
