// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/base/thread_pool.h"
#include "glissade/linear/schur_operator.h"
#include "glissade/structure/structure.h"
#include "linear/schur_batches.h"

namespace glissade {

/// Where a block of S is: element (r, c) at data()[offset + r + c * stride].
struct BlockPlace {
  std::int64_t offset = -1;  ///< -1: not stored in this form
  std::int32_t stride = 0;

  [[nodiscard]] bool stored() const { return offset >= 0; }
};

/// Storage of the reduced system in the form that a solver asked for, and where each part of the
/// problem adds to it: tables made once per analysis and form.
///
/// S is stored by block columns, column-major: a block column's stored blocks lie one below the
/// other, with one stride. In the dense form that is the lower triangle of an n x n square; else
/// only what can be non-zero takes room. Block columns do not overlap, so tasks that own different
/// ones may write at the same time.
class SchurStorage final : public SchurOperator {
 public:
  /// All blocks that can be non-zero, whatever is stored.
  const SchurLayout& AllBlocks(const Structure& structure);
  /// Makes room and tables, if structure or form are new; wanted: of kSomeBlocks, indices in the
  /// pattern. Blocks outside the pattern are zero.
  void LayOut(const Structure& structure, SchurForm form, std::span<const std::int32_t> wanted);
  [[nodiscard]] SchurForm form() const { return form_; }

  // --- What is added where -----------------------------------------------------------------------
  [[nodiscard]] double* data() { return data_.data(); }
  /// Right-hand side.
  [[nodiscard]] std::vector<double>& rhs() { return rhs_; }
  [[nodiscard]] const std::vector<double>& rhs() const { return rhs_; }
  /// Place of a block; row >= col.
  [[nodiscard]] BlockPlace Find(std::int32_t row, std::int32_t col) const;
  /// By k of Structure::reduced_pattern(): blocks [ColumnBegin(c), ColumnBegin(c + 1)) are those of
  /// block column c.
  [[nodiscard]] BlockPlace Place(std::size_t k) const {
    return {place_[k], stride_[static_cast<std::size_t>(all_.blocks[k].col)]};
  }
  [[nodiscard]] std::size_t ColumnBegin(int col) const {
    return static_cast<std::size_t>(column_begin_[static_cast<std::size_t>(col)]);
  }
  /// Index in Structure::varying_blocks() of the k-th block of the pattern, -1: not there.
  [[nodiscard]] std::int32_t VaryingBlock(std::size_t k) const { return varying_block_[k]; }
  /// Its first index in Structure::constant_blocks(), and the next one after c; -1: none.
  [[nodiscard]] std::int32_t FirstConstant(std::size_t k) const { return first_constant_[k]; }
  [[nodiscard]] std::int32_t NextConstant(std::int32_t c) const {
    return next_constant_[static_cast<std::size_t>(c)];
  }
  /// By index in Structure::groups().blocks.
  [[nodiscard]] const std::vector<BlockPlace>& group_places() const { return group_places_; }
  /// How landmarks that are not in groups add to S.
  [[nodiscard]] const SchurBatches& batches() const { return batches_; }
  /// Cuts the block columns into about `count` ranges of about equal work: range k is [cuts[k],
  /// cuts[k + 1]).
  const std::vector<std::int32_t>& CutColumns(int count);

  // --- SchurOperator -----------------------------------------------------------------------------
  [[nodiscard]] const SchurLayout& layout() const override { return layout_; }
  [[nodiscard]] BlockView Block(std::size_t k) const override;
  void Multiply(const double* x, double* y) const override;
  bool PoseDiagonal(std::int32_t vertex, double* block) const override;
  /// What whoever has H does for S: y = S x without S, where it is not stored whole, and
  /// PoseBlock().
  struct Owner {
    void* self = nullptr;
    void (*multiply)(void* self, const double* x, double* y) = nullptr;
    bool (*pose_block)(void* self, std::int32_t vertex, double* block) = nullptr;
    ThreadPool* threads = nullptr;
  };
  void SetOwner(const Owner& owner) { owner_ = owner; }

 private:
  /// Returns the numbers that all stored blocks take.
  std::int64_t MakePlaces();
  void CutProduct();
  void MultiplyColumns(std::size_t begin, std::size_t end, const double* x, double* x_part,
                       double* y_part, double* y) const;
  void ListPoseBlocks(const Structure& structure);
  [[nodiscard]] std::size_t IndexOf(std::int32_t row, std::int32_t col) const;

  SchurForm form_ = SchurForm::kDense;
  std::uint64_t laid_out_ = 0;  // the analysis that the tables belong to
  SchurLayout all_, layout_;
  std::vector<std::int64_t> offsets_;
  std::vector<BlockIndex> pattern_;
  std::vector<BlockIndex> stored_;          // layout_.blocks, where that is not the pattern
  std::vector<std::int32_t> stored_index_;  // of each of them in the pattern
  std::vector<std::int32_t> wanted_;        // of kSomeBlocks
  std::vector<double> data_, rhs_;
  std::vector<std::int64_t> column_;  // by vertex: offset of its block column
  std::vector<std::int32_t> stride_;
  std::vector<std::int32_t> column_begin_;                    // in the pattern
  std::vector<std::int64_t> place_;                           // by block of the pattern
  std::vector<std::int32_t> varying_block_, first_constant_;  // the same
  std::vector<std::int32_t> next_constant_;
  std::vector<BlockPlace> group_places_;
  SchurBatches batches_;
  std::vector<std::int32_t> cuts_;
  int num_cuts_ = 0;
  std::vector<std::int64_t> work_;
  Owner owner_;
  // Of products with stored blocks: parts of the block columns, and what each has for itself.
  std::vector<std::int32_t> product_cuts_;
  struct ProductPart {
    std::vector<double> x, y, sum;
  };
  mutable std::vector<ProductPart> product_parts_;
};

}  // namespace glissade
