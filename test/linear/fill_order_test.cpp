// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/fill_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "glissade/linear/sparse_cholesky.h"

namespace glissade {
namespace {

/// Cameras on a grid of streets that see their neighbours up to two away.
struct Grid {
  explicit Grid(int side, int dim = 1) {
    const int n = side * side;
    offsets.push_back(0);
    for (int v = 0; v < n; ++v)
      offsets.push_back(offsets.back() + dim);
    for (std::int32_t c = 0; c < n; ++c) {
      for (std::int32_t r = c; r < n; ++r) {
        const int dx = r % side - c % side, dy = r / side - c / side;
        if (dx * dx + dy * dy <= 4) blocks.push_back({r, c});
      }
    }
    layout = {offsets, blocks, 1};
  }
  std::vector<std::int64_t> offsets;
  std::vector<BlockIndex> blocks;
  SchurLayout layout;
};

/// Blocks of the factor, by eliminating.
std::size_t Fill(const SchurLayout& layout, const std::vector<std::int32_t>& order) {
  std::vector<std::size_t> position(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    position[static_cast<std::size_t>(order[k])] = k;
  std::vector<std::set<std::size_t>> column(order.size());
  for (const BlockIndex& block : layout.blocks) {
    const std::size_t a = position[static_cast<std::size_t>(block.row)];
    const std::size_t b = position[static_cast<std::size_t>(block.col)];
    if (a != b) column[std::min(a, b)].insert(std::max(a, b));
  }
  std::size_t fill = 0;
  for (std::set<std::size_t>& rows : column) {
    fill += rows.size();
    if (rows.empty()) continue;
    const std::size_t parent = *rows.begin();
    rows.erase(rows.begin());
    column[parent].insert(rows.begin(), rows.end());
  }
  return fill;
}

TEST(FillOrder, IsAPermutationTheSameEveryTimeWithLittleFill) {
  // Exact minimum degree, approximate, and (where it is built in) dissection.
  for (const int side : {7, 30, 48}) {
    const Grid grid(side);
    std::vector<std::int32_t> order, again, natural;
    FillOrder fill_order;
    fill_order.Find(grid.layout, &order);
    FillOrder().Find(grid.layout, &again);
    EXPECT_EQ(order, again);
    natural = order;
    std::sort(natural.begin(), natural.end());
    ASSERT_EQ(natural.size(), static_cast<std::size_t>(side * side));
    for (std::size_t k = 0; k < natural.size(); ++k)
      ASSERT_EQ(natural[k], static_cast<std::int32_t>(k));
    // In the order in which they are numbered the fill grows as n^1.5, here as n log n.
    const double ratio = static_cast<double>(Fill(grid.layout, order)) /
                         static_cast<double>(Fill(grid.layout, natural));
    EXPECT_LT(ratio, side < 10 ? 1.0 : 0.7) << side;
  }
}

TEST(FillOrder, TellsWhatTheFactorizationWillTake) {
  SparseCholeskySolver small, large;
  const Grid few(20, 6), many(45, 6);
  small.Analyze(few.layout);
  large.Analyze(many.layout);
  EXPECT_GT(small.Flops(), 0.0);
  EXPECT_GT(large.Flops(), 5.0 * small.Flops());
  EXPECT_GT(large.MemoryBytes(), 4 * small.MemoryBytes());
  EXPECT_LT(large.FlopRatio(), 0.01);
}

}  // namespace
}  // namespace glissade
