// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace glissade::internal {

/// Cuts a row of items into at most `parts` ranges of about equal work: range k is [cuts[k], cuts[k
/// + 1]), together they are all items.
inline void CutEvenly(const std::vector<std::int64_t>& work, int parts,
                      std::vector<std::int32_t>* cuts) {
  const std::int64_t total = std::accumulate(work.begin(), work.end(), std::int64_t{0});
  cuts->assign(1, 0);
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < work.size(); ++k) {
    const auto ranges = static_cast<std::int64_t>(cuts->size());
    if (k > 0 && ranges < parts && sum * parts >= total * ranges)
      cuts->push_back(static_cast<std::int32_t>(k));
    sum += work[k];
  }
  cuts->push_back(static_cast<std::int32_t>(work.size()));
}

}  // namespace glissade::internal
