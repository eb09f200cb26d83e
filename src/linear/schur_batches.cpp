// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/schur_batches.h"

#include <algorithm>

#include "glissade/base/index.h"
#include "linear/cut_evenly.h"
#include "linear/schur_storage.h"

namespace glissade {

namespace {

using internal::Index;

/// With blocks of 9 x 3 their Z takes 220 kB. Numbers of slots must fit into 16 bits, so that a
/// landmark with more slots than this is a batch of its own (Structure refuses those above 2^16).
constexpr std::int32_t kMaxSlots = 1024;
constexpr std::int32_t kMaxLandmarks = 512;

}  // namespace

void SchurBatches::List(const Structure& structure, const SchurStorage& storage) {
  CutIntoBatches(structure);
  blocks_.clear();
  pairs_.clear();
  local_.assign(structure.poses().size(), -1);
  for (Batch& batch : batches_)
    ListBlocks(structure, storage, &batch);
  if (!structure.IsLarge()) return;
  blocks_.shrink_to_fit();
  pairs_.shrink_to_fit();
  slot_.shrink_to_fit();
  landmark_.shrink_to_fit();
}

void SchurBatches::CutIntoBatches(const Structure& structure) {
  batches_.clear();
  slot_.clear();
  landmark_.clear();
  max_z_size_ = max_beta_size_ = 0;
  const std::vector<LandmarkBlock>& landmarks = structure.landmarks();
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    const LandmarkBlock& landmark = landmarks[l];
    const bool begins =
        batches_.empty() || batches_.back().dl != landmark.dim ||
        landmark.slot_end - batches_.back().slot_begin > kMaxSlots ||
        batches_.back().landmark_end - batches_.back().landmark_begin >= kMaxLandmarks;
    if (begins) {
      Batch batch;
      batch.landmark_begin = batch.landmark_end = static_cast<std::int32_t>(l);
      batch.slot_begin = landmark.slot_begin;
      batch.dl = landmark.dim;
      batch.dim = landmark.slot_begin < landmark.slot_end
                      ? structure.slot_dim()[Index(landmark.slot_begin)]
                      : 0;
      batches_.push_back(batch);
    }
    Batch& batch = batches_.back();
    for (std::int32_t s = landmark.slot_begin; s < landmark.slot_end; ++s) {
      const std::int32_t dim = structure.slot_dim()[Index(s)];
      slot_.push_back(batch.z_size);
      landmark_.push_back(static_cast<std::uint16_t>(batch.landmark_end - batch.landmark_begin));
      batch.z_size += dim * batch.dl;
      if (dim != batch.dim) batch.dim = 0;
    }
    ++batch.landmark_end;
    max_z_size_ = std::max(max_z_size_, Index(batch.z_size));
    max_beta_size_ =
        std::max(max_beta_size_, Index((batch.landmark_end - batch.landmark_begin) * batch.dl));
  }
}

void SchurBatches::ListBlocks(const Structure& structure, const SchurStorage& storage,
                              Batch* batch) {
  batch->pair_begin = static_cast<std::int64_t>(pairs_.size());
  batch->block_begin = static_cast<std::int64_t>(blocks_.size());
  ListItems(structure, *batch, storage.form() == SchurForm::kDiagonalBlocks);
  // By column, then row; landmarks in order within a block.
  SortItems(&Item::row);
  SortItems(&Item::col);
  std::int32_t pairs = 0;
  for (std::size_t k = 0; k < items_.size();) {
    const Item& first = items_[k];
    std::size_t end = k + 1;
    while (end < items_.size() && items_[end].row == first.row && items_[end].col == first.col)
      ++end;
    const std::int32_t row = vertices_[Index(first.row)], col = vertices_[Index(first.col)];
    const BlockPlace place = storage.Find(row, col);
    if (place.stored()) {
      const PoseBlock &r = structure.poses()[Index(row)], &c = structure.poses()[Index(col)];
      const auto count = static_cast<std::int32_t>(end - k);
      blocks_.push_back({place.offset, place.stride, row == col ? r.offset : -1, pairs,
                         pairs + count, col, static_cast<std::uint16_t>(r.dim),
                         static_cast<std::uint16_t>(c.dim)});
      pairs += count;
      for (; k < end; ++k)
        pairs_.push_back(items_[k].pair);
    }
    k = end;
  }
  batch->block_end = static_cast<std::int64_t>(blocks_.size());
}

void SchurBatches::ListItems(const Structure& structure, const Batch& batch, bool diagonal_only) {
  const std::vector<std::int32_t>& vertex = structure.slot_block();
  const std::int32_t slot_end = structure.landmarks()[Index(batch.landmark_end - 1)].slot_end;
  for (const std::int32_t v : vertices_)
    local_[Index(v)] = -1;
  vertices_.clear();
  for (std::int32_t s = batch.slot_begin; s < slot_end; ++s) {
    std::int32_t& local = local_[Index(vertex[Index(s)])];
    if (local < 0) vertices_.push_back(vertex[Index(s)]);
    local = 0;
  }
  std::sort(vertices_.begin(), vertices_.end());
  for (std::size_t k = 0; k < vertices_.size(); ++k)
    local_[Index(vertices_[k])] = static_cast<std::int32_t>(k);
  items_.clear();
  for (std::int32_t l = batch.landmark_begin; l < batch.landmark_end; ++l) {
    const LandmarkBlock& landmark = structure.landmarks()[Index(l)];
    for (std::int32_t c = landmark.slot_begin; c < landmark.slot_end; ++c) {
      const std::int32_t end = diagonal_only ? c + 1 : landmark.slot_end;
      for (std::int32_t r = c; r < end; ++r) {
        items_.push_back({local_[Index(vertex[Index(r)])],
                          local_[Index(vertex[Index(c)])],
                          {static_cast<std::uint16_t>(r - batch.slot_begin),
                           static_cast<std::uint16_t>(c - batch.slot_begin)}});
      }
    }
  }
}

// Stable, in a time that grows with the number of items.
void SchurBatches::SortItems(std::int32_t Item::*key) {
  count_.assign(vertices_.size() + 1, 0);
  for (const Item& item : items_)
    ++count_[Index(item.*key) + 1];
  for (std::size_t k = 1; k < count_.size(); ++k)
    count_[k] += count_[k - 1];
  sorted_.resize(items_.size());
  for (const Item& item : items_)
    sorted_[Index(count_[Index(item.*key)]++)] = item;
  items_.swap(sorted_);
}

std::pair<const kernels::SchurBlock*, const kernels::SchurBlock*> SchurBatches::Blocks(
    std::size_t k, std::int32_t begin, std::int32_t end) const {
  const kernels::SchurBlock* const first = blocks_.data() + batches_[k].block_begin;
  const kernels::SchurBlock* const last = blocks_.data() + batches_[k].block_end;
  const auto from = [&](std::int32_t col) {
    return std::partition_point(first, last,
                                [col](const kernels::SchurBlock& b) { return b.col < col; });
  };
  return {from(begin), from(end)};
}

void SchurBatches::CutColumns(std::size_t first, std::size_t count, std::int32_t num_columns,
                              int parts, std::vector<std::int32_t>* cuts) const {
  work_.assign(Index(num_columns), 0);
  const std::int64_t end = batches_[first + count - 1].block_end;
  for (std::int64_t k = batches_[first].block_begin; k < end; ++k) {
    const kernels::SchurBlock& block = blocks_[Index(k)];
    // A block is read and written once, and each pair of slots adds to it.
    work_[Index(block.col)] += 2 + block.pair_end - block.pair_begin;
  }
  internal::CutEvenly(work_, parts, cuts);
}

kernels::SchurPanel SchurBatches::Panel(std::size_t k, const double* z, const double* beta) const {
  const Batch& batch = batches_[k];
  return {batch.dl,
          batch.dim,
          z,
          slot_.data() + batch.slot_begin,
          landmark_.data() + batch.slot_begin,
          beta,
          pairs_.data() + batch.pair_begin};
}

}  // namespace glissade
