// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "glissade/structure/structure.h"

#include "glissade/base/index.h"

namespace glissade {

namespace {

using internal::Index;

/// Counting sort by block: items of block b are out[begin[b], begin[b + 1]). for_each(f) calls
/// f(block, item) for all, the same way each time.
template <class ForEach>
void SortByBlock(std::size_t num_blocks, ForEach&& for_each, std::vector<std::int32_t>* begin,
                 std::vector<std::int32_t>* out) {
  begin->assign(num_blocks + 2, 0);
  for_each([&](std::int32_t block, std::int32_t) { ++(*begin)[Index(block) + 2]; });
  for (std::size_t b = 0; b < num_blocks; ++b)
    (*begin)[b + 2] += (*begin)[b + 1];
  out->resize(Index((*begin)[num_blocks + 1]));
  for_each([&](std::int32_t block, std::int32_t item) {
    (*out)[Index((*begin)[Index(block) + 1]++)] = item;
  });
}

}  // namespace

// The time goes with the sum over landmarks of their slots squared, the memory with slots and
// blocks: nothing here is as large as the square of the number of poses.
void Structure::BuildReducedPattern() {
  const std::size_t n = poses_.size();
  SortByBlock(
      n,
      [&](auto&& f) {
        for (const PoseBlockPair& pair : h_blocks_)
          f(pair.col, pair.row);
        for (const LandmarkPlanBlock& block : plan_.blocks)
          f(block.col, block.row);
      },
      &column_begin_, &column_rows_);
  SortByBlock(
      n,
      [&](auto&& f) {
        for (std::size_t l = 0; l < landmarks_.size(); ++l) {
          for (std::int32_t s = landmarks_[l].slot_begin; s < landmarks_[l].slot_end; ++s)
            f(slot_block_[Index(s)], static_cast<std::int32_t>(l));
        }
      },
      &seen_begin_, &seen_landmarks_);
  reduced_pattern_.clear();
  stamp_of_block_.assign(n, -1);
  for (std::size_t c = 0; c < n; ++c) {
    const auto col = static_cast<std::int32_t>(c);
    const std::size_t first = reduced_pattern_.size();
    const auto add = [&](std::int32_t row) {
      if (stamp_of_block_[Index(row)] == col) return;
      stamp_of_block_[Index(row)] = col;
      reduced_pattern_.push_back({row, col});
    };
    for (std::int32_t k = column_begin_[c]; k < column_begin_[c + 1]; ++k)
      add(column_rows_[Index(k)]);
    for (std::int32_t k = seen_begin_[c]; k < seen_begin_[c + 1]; ++k) {
      // Slots ascend: a landmark's last ones are its rows in this column.
      const LandmarkBlock& landmark = landmarks_[Index(seen_landmarks_[Index(k)])];
      for (std::int32_t s = landmark.slot_end; slot_block_[Index(s - 1)] != col; --s)
        add(slot_block_[Index(s - 1)]);
    }
    std::sort(reduced_pattern_.begin() + static_cast<std::ptrdiff_t>(first), reduced_pattern_.end(),
              [](const BlockIndex& a, const BlockIndex& b) { return a.row < b.row; });
  }
}

}  // namespace glissade
