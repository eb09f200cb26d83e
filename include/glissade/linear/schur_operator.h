// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "glissade/structure/block_index.h"

namespace glissade {

/// In which form a solver wants the reduced system S to be stored.
enum class SchurForm : std::uint8_t {
  kDense,           ///< one n x n block, lower triangle
  kBlocks,          ///< the blocks of the lower triangle that can be non-zero
  kDiagonalBlocks,  ///< diagonal blocks alone: S itself is only applied, never formed
  kSomeBlocks,      ///< those of LinearSolver::WantedBlocks(); S is applied as well
};

/// The blocks of S: one row and column of blocks per free vertex that is not eliminated. A block
/// always has its vertices' full tangent dimensions.
struct SchurLayout {
  /// First scalar of each vertex's part of x; offsets.back() == n. Never empty.
  std::span<const std::int64_t> offsets;
  /// Blocks of the lower triangle (row >= col), by column, rows ascending within one. Where S is
  /// stored as kDense: one block {0, 0}, which is all of S.
  std::span<const BlockIndex> blocks;
  /// Where this number is the same, offsets and blocks are. Never 0.
  std::uint64_t version = 0;

  [[nodiscard]] std::int64_t size() const { return offsets.back(); }
  [[nodiscard]] std::size_t num_vertices() const { return offsets.size() - 1; }
  [[nodiscard]] int Dim(std::int32_t vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return static_cast<int>(offsets[v + 1] - offsets[v]);
  }
};

/// A stored block, column-major: element (r, c) is data[r + c * stride]. Of diagonal blocks (and of
/// the block of kDense) the lower triangle counts.
struct BlockView {
  const double* data = nullptr;
  std::int64_t stride = 0;
};

/// The reduced system S = H_pp - W H_ll^-1 W', symmetric, with the damping in it. Valid during the
/// call that it is handed to.
///
/// Coordinates of partly fixed vertices that are not free are present as unit rows (S_kk = 1, b_k =
/// 0).
class SchurOperator {
 public:
  virtual ~SchurOperator() = default;
  /// What is stored: what LinearSolver::Form() asked for.
  [[nodiscard]] virtual const SchurLayout& layout() const = 0;
  /// The k-th of layout().blocks.
  [[nodiscard]] virtual BlockView Block(std::size_t k) const = 0;
  /// The diagonal block of H_pp, with the damping, of a vertex: dim x dim, column-major. False
  /// where H_pp has other blocks besides.
  virtual bool PoseDiagonal(std::int32_t vertex, double* block) const {
    static_cast<void>(vertex);
    static_cast<void>(block);
    return false;
  }
  /// y = S x, whatever is stored. x and y (layout().size() numbers each) must not overlap.
  virtual void Multiply(const double* x, double* y) const = 0;
};

}  // namespace glissade
