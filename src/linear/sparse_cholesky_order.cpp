// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The order in which SparseCholeskySolver eliminates.

#include <algorithm>
#include <bit>

#include "glissade/base/index.h"
#include "glissade/linear/sparse_cholesky.h"

namespace glissade {

using internal::Index;

// Minimum degree on the elimination graph itself, as bit rows: exact, and cheap for up to a few
// thousand blocks. Ties go to the lower number, so the order is the same every time.
void SparseCholeskySolver::Order(const SchurLayout& layout) {
  const int n = static_cast<int>(layout.num_vertices());
  const std::size_t words = Index((n + 63) / 64);
  adjacency_.assign(Index(n) * words, 0);
  const auto row_of = [&](int block) { return adjacency_.data() + Index(block) * words; };
  const auto set = [](std::uint64_t* row, int bit) {
    row[bit / 64] |= std::uint64_t{1} << (bit % 64);
  };
  for (const BlockIndex& block : layout.blocks) {
    set(row_of(block.row), block.col);
    set(row_of(block.col), block.row);
  }
  const auto for_each = [&](const std::uint64_t* row, auto&& f) {
    for (std::size_t w = 0; w < words; ++w) {
      for (std::uint64_t bits = row[w]; bits != 0; bits &= bits - 1) {
        f(static_cast<int>(w * 64) + std::countr_zero(bits));
      }
    }
  };
  for (int i = 0; i < n; ++i)
    row_of(i)[i / 64] &= ~(std::uint64_t{1} << (i % 64));

  column_.resize(std::max(column_.size(), Index(n)));
  order_.clear();
  position_.assign(Index(n), -1);
  local_.assign(Index(n), 0);  // degree in scalars
  for (int i = 0; i < n; ++i) {
    for_each(row_of(i), [&](int j) { local_[Index(i)] += layout.Dim(j); });
  }
  for (int step = 0; step < n; ++step) {
    int best = -1;
    for (int i = 0; i < n; ++i) {
      if (position_[Index(i)] < 0 && (best < 0 || local_[Index(i)] < local_[Index(best)])) best = i;
    }
    position_[Index(best)] = step;
    order_.push_back(best);
    std::vector<std::int32_t>& column = column_[Index(best)];
    column.clear();
    const std::uint64_t* eliminated = row_of(best);
    for_each(eliminated, [&](int j) { column.push_back(j); });
    // The neighbours become a clique without the eliminated block.
    for (const std::int32_t j : column) {
      std::uint64_t* row = row_of(j);
      for (std::size_t w = 0; w < words; ++w)
        row[w] |= eliminated[w];
      row[j / 64] &= ~(std::uint64_t{1} << (j % 64));
      row[best / 64] &= ~(std::uint64_t{1} << (best % 64));
      local_[Index(j)] = 0;
      for_each(row, [&](int k) { local_[Index(j)] += layout.Dim(k); });
    }
  }
  for (int i = 0; i < n; ++i) {
    std::sort(column_[Index(i)].begin(), column_[Index(i)].end(),
              [&](int a, int b) { return position_[Index(a)] < position_[Index(b)]; });
  }
}

}  // namespace glissade
