// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "glissade/structure/structure.h"

namespace glissade {

/// A dense block, row-major.
struct DenseBlock {
  const double* data = nullptr;
  int rows = 0;
  int cols = 0;

  double operator()(int r, int c) const { return data[r * cols + c]; }
};

/// H = J'J by its parts, read only: blocks of the vertices that are not eliminated ("poses", in the
/// order of Structure::poses()), of pairs of them, and of each landmark (Structure::landmarks())
/// with what couples it to the poses. A view: valid until the next Linearize().
///
/// Blocks have the full tangent dimension of their vertices. Of a partly fixed one the free
/// coordinates come first; rows and columns of those that are held are zero.
class Hessian {
 public:
  /// What one landmark has: H_ll, b_l and W = H_pl by slot.
  class LandmarkPart {
   public:
    [[nodiscard]] int dim() const { return block_->dim; }
    [[nodiscard]] DenseBlock H() const { return {record_, dim(), dim()}; }
    /// dim() numbers: minus the gradient.
    [[nodiscard]] const double* b() const { return record_ + dim() * dim(); }
    /// Poses that it is coupled to, ascending.
    [[nodiscard]] int num_slots() const { return block_->slot_end - block_->slot_begin; }
    [[nodiscard]] std::int32_t pose(int slot) const { return structure_->slot_block()[Slot(slot)]; }
    /// First scalar of that pose.
    [[nodiscard]] std::int32_t row(int slot) const { return structure_->slot_row()[Slot(slot)]; }
    /// H of that pose and the landmark: dim(pose) x dim().
    [[nodiscard]] DenseBlock W(int slot) const {
      const double* w = b() + dim();
      for (int s = 0; s < slot; ++s)
        w += structure_->slot_dim()[Slot(s)] * dim();
      return {w, structure_->slot_dim()[Slot(slot)], dim()};
    }

   private:
    friend class Hessian;
    LandmarkPart(const Structure* structure, const LandmarkBlock* block, const double* record)
        : structure_(structure), block_(block), record_(record) {}
    [[nodiscard]] std::size_t Slot(int slot) const {
      return static_cast<std::size_t>(block_->slot_begin + slot);
    }
    const Structure* structure_;
    const LandmarkBlock* block_;
    const double* record_;  // [H_ll | b_l | W of slot 0 | ...]
  };
  /// Block (row, col), row >= col, of two poses that some edge shares, or of one.
  struct PosePair {
    std::int32_t row = 0;
    std::int32_t col = 0;
    DenseBlock H;
  };

  /// h_pp: by PoseBlockPair::offset; landmarks: by LandmarkBlock::record.
  Hessian(const Structure& structure, const double* h_pp, const double* landmarks)
      : structure_(&structure), h_pp_(h_pp), landmarks_(landmarks) {}

  [[nodiscard]] int num_poses() const { return static_cast<int>(structure_->poses().size()); }
  /// First scalar of a pose.
  [[nodiscard]] std::int32_t offset(int pose) const {
    return structure_->poses()[static_cast<std::size_t>(pose)].offset;
  }
  [[nodiscard]] DenseBlock Diagonal(int pose) const {
    const PoseBlock& block = structure_->poses()[static_cast<std::size_t>(pose)];
    return {h_pp_ + block.h_diagonal, block.dim, block.dim};
  }
  /// All pairs that are not zero, diagonal ones among them.
  [[nodiscard]] std::size_t num_pairs() const { return structure_->h_blocks().size(); }
  [[nodiscard]] PosePair Pair(std::size_t k) const {
    const PoseBlockPair& pair = structure_->h_blocks()[k];
    return {pair.row,
            pair.col,
            {h_pp_ + pair.offset, structure_->poses()[static_cast<std::size_t>(pair.row)].dim,
             structure_->poses()[static_cast<std::size_t>(pair.col)].dim}};
  }
  [[nodiscard]] std::size_t num_landmarks() const { return structure_->landmarks().size(); }
  [[nodiscard]] LandmarkPart Landmark(std::size_t l) const {
    const LandmarkBlock& block = structure_->landmarks()[l];
    return {structure_, &block, landmarks_ + block.record};
  }

 private:
  const Structure* structure_;
  const double* h_pp_;
  const double* landmarks_;
};

}  // namespace glissade
