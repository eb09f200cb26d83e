// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <bit>

#include "glissade/structure/structure.h"

namespace glissade {

namespace {
// With more of the blocks than this there is nothing to gain from leaving some out.
constexpr double kDenseFraction = 0.8;
}  // namespace

void Structure::BuildReducedPattern() {
  // Bit rows: each landmark makes a clique of the pose blocks that see it.
  const std::size_t n = poses_.size();
  const std::size_t words = (n + 63) / 64;
  adjacency_.assign(n * words, 0);
  slot_mask_.resize(words);
  for (const LandmarkBlock& landmark : landmarks_) {
    slot_mask_.assign(words, 0);
    const std::int32_t* begin = slot_block_.data() + landmark.slot_begin;
    const std::int32_t* end = slot_block_.data() + landmark.slot_end;
    for (const std::int32_t* b = begin; b != end; ++b) {
      slot_mask_[static_cast<std::size_t>(*b) / 64] |= std::uint64_t{1} << (*b % 64);
    }
    for (const std::int32_t* b = begin; b != end; ++b) {
      std::uint64_t* row = adjacency_.data() + static_cast<std::size_t>(*b) * words;
      for (std::size_t w = 0; w < words; ++w)
        row[w] |= slot_mask_[w];
    }
  }
  for (const PoseBlockPair& pair : h_blocks_) {
    adjacency_[static_cast<std::size_t>(pair.row) * words +
               static_cast<std::size_t>(pair.col) / 64] |= std::uint64_t{1} << (pair.col % 64);
  }
  for (const ReprojectionBlock& block : plan_.blocks) {
    adjacency_[static_cast<std::size_t>(block.row) * words +
               static_cast<std::size_t>(block.col) / 64] |= std::uint64_t{1} << (block.col % 64);
  }
  reduced_pattern_.clear();
  for (std::size_t row = 0; row < n; ++row) {
    for (std::size_t w = 0; w <= row / 64; ++w) {
      for (std::uint64_t bits = adjacency_[row * words + w]; bits != 0; bits &= bits - 1) {
        const std::size_t col = w * 64 + static_cast<std::size_t>(std::countr_zero(bits));
        if (col > row) break;
        reduced_pattern_.push_back(
            {static_cast<std::int32_t>(row), static_cast<std::int32_t>(col)});
      }
    }
  }
  const double all = 0.5 * static_cast<double>(n) * static_cast<double>(n + 1);
  if (static_cast<double>(reduced_pattern_.size()) > kDenseFraction * all) {
    reduced_pattern_.clear();
  }
}

}  // namespace glissade
