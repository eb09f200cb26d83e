// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "glissade/structure/structure.h"
#include "kernels/schur.h"

namespace glissade {

class SchurStorage;

/// Landmarks in batches that are eliminated together (kernels/schur.h): consecutive ones of one
/// dimension, as many as leave Z in the second-level cache. Of each batch the blocks of S that it
/// adds to, by column, and the pairs of slots that add to each of them.
class SchurBatches {
 public:
  struct Batch {
    std::int32_t landmark_begin = 0, landmark_end = 0;
    std::int32_t slot_begin = 0;  ///< of Structure's slots
    std::int32_t dl = 0;
    std::int32_t dim = 0;     ///< of all slots; 0: they differ
    std::int32_t z_size = 0;  ///< numbers of Z
    std::int64_t pair_begin = 0;
    std::int64_t block_begin = 0, block_end = 0;
  };

  /// Of a new analysis, or where blocks are at other places in S.
  void List(const Structure& structure, const SchurStorage& storage);

  [[nodiscard]] std::size_t size() const { return batches_.size(); }
  [[nodiscard]] const Batch& operator[](std::size_t k) const { return batches_[k]; }
  /// What one batch of any needs at most.
  [[nodiscard]] std::size_t max_z_size() const { return max_z_size_; }
  [[nodiscard]] std::size_t max_beta_size() const { return max_beta_size_; }

  /// The blocks of a batch in block columns [begin, end).
  [[nodiscard]] std::pair<const kernels::SchurBlock*, const kernels::SchurBlock*> Blocks(
      std::size_t k, std::int32_t begin, std::int32_t end) const;
  /// Cuts the block columns that `count` batches from `first` on add to into about `parts` ranges
  /// of about equal work, which cover [0, num_columns): range k is [cuts[k], cuts[k + 1]).
  void CutColumns(std::size_t first, std::size_t count, std::int32_t num_columns, int parts,
                  std::vector<std::int32_t>* cuts) const;
  [[nodiscard]] kernels::SchurPanel Panel(std::size_t k, const double* z, const double* beta) const;

 private:
  /// A pair of slots and its place: vertices by their number in the batch.
  struct Item {
    std::int32_t row, col;
    kernels::SlotPair pair;
  };
  void CutIntoBatches(const Structure& structure);
  void ListBlocks(const Structure& structure, const SchurStorage& storage, Batch* batch);
  void ListItems(const Structure& structure, const Batch& batch, bool diagonal_only);
  void SortItems(std::int32_t Item::*key);

  std::vector<Batch> batches_;
  std::vector<std::int32_t> slot_;       // by slot: where it begins in its batch's Z
  std::vector<std::uint16_t> landmark_;  // by slot: its landmark's number in the batch
  std::vector<kernels::SchurBlock> blocks_;
  std::vector<kernels::SlotPair> pairs_;
  std::size_t max_z_size_ = 0, max_beta_size_ = 0;
  mutable std::vector<std::int64_t> work_;
  // Scratch.
  std::vector<std::int32_t> vertices_;  // of the batch, ascending
  std::vector<std::int32_t> local_;     // by vertex: its number among them
  std::vector<std::int32_t> count_;
  std::vector<Item> items_, sorted_;
};

}  // namespace glissade
