// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/schur_storage.h"

#include <algorithm>
#include <numeric>

#include "glissade/base/index.h"
#include "kernels/kernels.h"
#include "linear/cut_evenly.h"

namespace glissade {

namespace {

using internal::Index;

/// Columns a multiple of 8 apart: aligned relative to each other, and the masked tail of a short
/// one does not overlap the next.
std::int32_t PaddedStride(std::int64_t rows) {
  return static_cast<std::int32_t>((rows + 7) / 8 * 8);
}

}  // namespace

const SchurLayout& SchurStorage::AllBlocks(const Structure& structure) {
  if (all_.version == structure.analysis()) return all_;
  offsets_.assign(structure.pose_offsets().begin(), structure.pose_offsets().end());
  pattern_ = structure.reduced_pattern();
  all_ = {offsets_, pattern_, structure.analysis()};
  const std::size_t n = all_.num_vertices();
  column_begin_.assign(n + 1, 0);
  for (const BlockIndex& block : all_.blocks)
    ++column_begin_[Index(block.col) + 1];
  std::partial_sum(column_begin_.begin(), column_begin_.end(), column_begin_.begin());
  return all_;
}

void SchurStorage::LayOut(const Structure& structure, SchurForm form,
                          std::span<const std::int32_t> wanted) {
  AllBlocks(structure);
  if (laid_out_ == structure.analysis() && form_ == form && std::ranges::equal(wanted_, wanted))
    return;
  laid_out_ = 0;
  form_ = form;
  wanted_.assign(wanted.begin(), wanted.end());
  const std::int64_t size = MakePlaces();
  cuts_.clear();
  ListPoseBlocks(structure);
  batches_.List(structure, *this);
  // After what takes room for a moment. In the dense form blocks outside the pattern are never
  // written: zero once.
  data_.assign(Index(size), 0.0);
  CutProduct();
  const LandmarkPlan& plan = structure.groups();
  group_places_.resize(plan.blocks.size());
  for (std::size_t k = 0; k < plan.blocks.size(); ++k)
    group_places_[k] = Find(plan.blocks[k].row, plan.blocks[k].col);
  rhs_.resize(Index(all_.size()));
  laid_out_ = structure.analysis();
}

std::int64_t SchurStorage::MakePlaces() {
  const std::size_t n = all_.num_vertices();
  column_.resize(n);
  stride_.resize(n);
  place_.assign(all_.blocks.size(), -1);
  stored_.clear();
  stored_index_.clear();
  auto next_wanted = wanted_.begin();
  const auto is_stored = [&](std::size_t k) {
    const BlockIndex block = all_.blocks[k];
    switch (form_) {
      case SchurForm::kDense:
      case SchurForm::kBlocks:
        return true;
      case SchurForm::kDiagonalBlocks:
        return block.row == block.col;
      case SchurForm::kSomeBlocks:
        break;
    }
    if (next_wanted == wanted_.end() || Index(*next_wanted) != k) return false;
    ++next_wanted;
    return true;
  };
  const bool lists = form_ == SchurForm::kDiagonalBlocks || form_ == SchurForm::kSomeBlocks;
  std::int64_t size = 0;
  for (std::size_t c = 0; c < n; ++c) {
    const std::int64_t width = all_.Dim(static_cast<std::int32_t>(c));
    const std::size_t begin = Index(column_begin_[c]), end = Index(column_begin_[c + 1]);
    if (form_ == SchurForm::kDense) {
      stride_[c] = PaddedStride(all_.size());
      column_[c] = all_.offsets[c] * stride_[c];
      for (std::size_t k = begin; k < end; ++k)
        place_[k] = column_[c] + all_.offsets[Index(all_.blocks[k].row)];
      size += width * stride_[c];
      continue;
    }
    column_[c] = size;
    std::int64_t height = 0;
    for (std::size_t k = begin; k < end; ++k) {
      if (!is_stored(k)) continue;
      place_[k] = size + height;
      height += all_.Dim(all_.blocks[k].row);
      if (!lists) continue;
      stored_.push_back(all_.blocks[k]);
      stored_index_.push_back(static_cast<std::int32_t>(k));
    }
    stride_[c] = PaddedStride(height);
    size += width * stride_[c];
  }
  if (form_ == SchurForm::kDense) stored_.push_back({0, 0});
  layout_ = all_;
  if (form_ != SchurForm::kBlocks) layout_.blocks = stored_;
  return size;
}

std::size_t SchurStorage::IndexOf(std::int32_t row, std::int32_t col) const {
  const auto begin = all_.blocks.begin() + column_begin_[Index(col)];
  const auto end = all_.blocks.begin() + column_begin_[Index(col) + 1];
  const auto at = std::lower_bound(begin, end, row,
                                   [](const BlockIndex& a, std::int32_t r) { return a.row < r; });
  return Index(at - all_.blocks.begin());
}

BlockPlace SchurStorage::Find(std::int32_t row, std::int32_t col) const {
  return Place(IndexOf(row, col));
}

void SchurStorage::ListPoseBlocks(const Structure& structure) {
  varying_block_.assign(all_.blocks.size(), -1);
  const std::span<const PoseBlockPair> pairs = structure.varying_blocks();
  for (std::size_t k = 0; k < pairs.size(); ++k)
    varying_block_[IndexOf(pairs[k].row, pairs[k].col)] = static_cast<std::int32_t>(k);
  first_constant_.assign(all_.blocks.size(), -1);
  next_constant_.clear();
  for (const ConstantBlock& block : structure.constant_blocks()) {
    const PoseBlockPair& pair = structure.h_blocks()[Index(block.pair)];
    std::int32_t& first = first_constant_[IndexOf(pair.row, pair.col)];
    next_constant_.push_back(first);
    first = static_cast<std::int32_t>(next_constant_.size()) - 1;
  }
}

const std::vector<std::int32_t>& SchurStorage::CutColumns(int count) {
  if (!cuts_.empty() && num_cuts_ == count) return cuts_;
  num_cuts_ = count;
  work_.resize(all_.num_vertices());
  for (std::size_t c = 0; c < work_.size(); ++c)
    work_[c] = column_begin_[c + 1] - column_begin_[c];
  internal::CutEvenly(work_, count, &cuts_);
  return cuts_;
}

BlockView SchurStorage::Block(std::size_t k) const {
  switch (form_) {
    case SchurForm::kDense:
      return {data_.data(), stride_.empty() ? 0 : stride_.front()};
    case SchurForm::kBlocks:
      return {data_.data() + place_[k], stride_[Index(all_.blocks[k].col)]};
    case SchurForm::kDiagonalBlocks:
    case SchurForm::kSomeBlocks:
      break;
  }
  const std::size_t index = Index(stored_index_[k]);
  return {data_.data() + place_[index], stride_[Index(all_.blocks[index].col)]};
}

bool SchurStorage::PoseDiagonal(std::int32_t vertex, double* block) const {
  return owner_.pose_block != nullptr && owner_.pose_block(owner_.self, vertex, block);
}

// Parts of about equal size, as many as there is work for: what is summed up in which order does
// not depend on threads.
void SchurStorage::CutProduct() {
  constexpr std::size_t kNumbersPerPart = 65536, kMaxParts = 8;
  const std::size_t n = all_.num_vertices();
  work_.assign(n, 0);
  int parts = 1;
  if (form_ == SchurForm::kBlocks) {
    parts = static_cast<int>(std::clamp<std::size_t>(data_.size() / kNumbersPerPart, 1, kMaxParts));
    const auto size = static_cast<std::int64_t>(data_.size());
    for (std::size_t c = 0; c < n; ++c)
      work_[c] = (c + 1 < n ? column_[c + 1] : size) - column_[c];
  }
  internal::CutEvenly(work_, parts, &product_cuts_);
  product_parts_.resize(product_cuts_.size() - 1);
  for (ProductPart& part : product_parts_) {
    part.x.resize(Index(all_.size()));
    part.y.resize(Index(all_.size()));
    part.sum.resize(product_parts_.size() > 1 ? Index(all_.size()) : 0);
  }
}

void SchurStorage::Multiply(const double* x, double* y) const {
  const auto n = static_cast<int>(all_.size());
  if (form_ == SchurForm::kDiagonalBlocks || form_ == SchurForm::kSomeBlocks)
    return owner_.multiply(owner_.self, x, y);
  if (form_ == SchurForm::kDense) {
    kernels::Kernels().symv_lower(n, data_.data(), stride_.empty() ? 0 : stride_.front(), x, y);
    return;
  }
  if (product_parts_.size() == 1) {
    ProductPart& part = product_parts_.front();
    return MultiplyColumns(0, all_.num_vertices(), x, part.x.data(), part.y.data(), y);
  }
  const auto multiply = [&](int k) {
    ProductPart& part = product_parts_[Index(k)];
    MultiplyColumns(Index(product_cuts_[Index(k)]), Index(product_cuts_[Index(k) + 1]), x,
                    part.x.data(), part.y.data(), part.sum.data());
  };
  if (owner_.threads != nullptr) {
    owner_.threads->Run(static_cast<int>(product_parts_.size()), [&](int k) { multiply(k); });
  } else {
    for (std::size_t k = 0; k < product_parts_.size(); ++k)
      multiply(static_cast<int>(k));
  }
  std::copy_n(product_parts_.front().sum.data(), n, y);
  for (std::size_t k = 1; k < product_parts_.size(); ++k)
    kernels::Kernels().axpy(n, 1.0, product_parts_[k].sum.data(), y);
}

// y = what block columns [begin, end) and their mirror image make of x.
void SchurStorage::MultiplyColumns(std::size_t begin, std::size_t end, const double* x,
                                   double* x_part, double* y_part, double* y) const {
  std::fill_n(y, all_.size(), 0.0);
  for (std::size_t c = begin; c < end; ++c) {
    // The rows of a block column one after the other, as it is stored.
    int rows = 0;
    const auto for_each_block = [&](auto&& f) {
      rows = 0;
      for (std::int32_t k = column_begin_[c]; k < column_begin_[c + 1]; ++k) {
        const std::int32_t row = all_.blocks[Index(k)].row;
        const int dim = all_.Dim(row);
        f(all_.offsets[Index(row)], rows, dim);
        rows += dim;
      }
    };
    for_each_block([&](std::int64_t from, int to, int dim) {
      std::copy_n(x + from, dim, x_part + to);
      std::fill_n(y_part + to, dim, 0.0);
    });
    kernels::Kernels().symv_lower_columns(rows, all_.Dim(static_cast<std::int32_t>(c)),
                                          data_.data() + column_[c], stride_[c], x_part, y_part);
    for_each_block([&](std::int64_t to, int from, int dim) {
      for (int r = 0; r < dim; ++r)
        y[to + r] += y_part[from + r];
    });
  }
}

}  // namespace glissade
