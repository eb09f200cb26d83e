// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/sparse_cholesky.h"

#include <algorithm>

#include "kernels/kernels.h"
#include "linear/block_copy.h"
#include "linear/threaded_cholesky.h"

#include "glissade/base/index.h"

namespace glissade {

namespace {
using internal::Index;
}  // namespace

bool SparseCholeskySolver::FactorFront(const SchurOperator& S, const Supernode& node,
                                       int* failed_pivot) {
  const std::int64_t stride = node.stride;
  double* const F = in_place_ ? factor_.data() + node.factor : front_.data();
  for (int c = 0; c < node.size; ++c)
    std::fill_n(F + c * stride + c, node.size - c, 0.0);

  for (std::int32_t e = node.entry_begin; e < node.entry_end; ++e) {
    const Entry& entry = entries_[Index(e)];
    const BlockView block = S.Block(Index(entry.block));
    const double* from = block.data;
    double* to = F + entry.front_row + entry.front_col * stride;
    if (!entry.transposed) {
      internal::CopyBlock<internal::BlockCopy::kSet>(entry.rows, entry.cols, from, block.stride, to,
                                                     stride);
    } else {
      for (int c = 0; c < entry.cols; ++c, from += block.stride, ++to) {
        for (int r = 0; r < entry.rows; ++r)
          to[r * stride] = from[r];
      }
    }
  }
  // Extend-add the children's Schur complements, block by block.
  for (std::int32_t k = node.child_begin; k < node.child_end; ++k) {
    const Supernode& child = nodes_[Index(children_[Index(k)])];
    const std::int64_t rows = in_place_ ? child.stride : child.size - child.cols;
    const double* update = in_place_ ? factor_.data() + child.factor + child.cols * (rows + 1)
                                     : stack_.data() + child.update;
    const std::int32_t first = child.block_begin + child.num_own;
    const std::int32_t* map = parent_offset_.data() + child.map_begin;
    for (std::int32_t j = first; j < child.block_end; ++j) {
      const std::int32_t col = block_offset_[Index(j)] - child.cols;
      const std::int32_t cols =
          (j + 1 < child.block_end ? block_offset_[Index(j + 1)] : child.size) -
          block_offset_[Index(j)];
      for (std::int32_t i = j; i < child.block_end; ++i) {
        const std::int32_t row = block_offset_[Index(i)] - child.cols;
        const std::int32_t count =
            (i + 1 < child.block_end ? block_offset_[Index(i + 1)] : child.size) -
            block_offset_[Index(i)];
        const double* from = update + row + col * rows;
        double* to = F + map[i - first] + map[j - first] * stride;
        internal::CopyBlock<internal::BlockCopy::kAdd>(count, cols, from, rows, to, stride);
      }
    }
  }

  const int info = ThreadedCholesky(node.size, node.cols, F, node.stride, threads_, &scratch_);
  if (info != 0) {
    std::int32_t k = node.block_begin;
    while (k + 1 < node.block_end && block_offset_[Index(k + 1)] < info)
      ++k;
    *failed_pivot = static_cast<int>(S.layout().offsets[Index(front_blocks_[Index(k)])]) + info -
                    1 - block_offset_[Index(k)];
    return false;
  }
  if (in_place_) return true;
  std::copy_n(F, stride * node.cols, factor_.data() + node.factor);
  const std::int64_t rows = node.size - node.cols;
  double* update = stack_.data() + node.update;
  for (std::int64_t c = 0; c < rows; ++c) {
    const double* from = F + (node.cols + c) * stride + node.cols;
    std::copy(from + c, from + rows, update + c * rows + c);
  }
  return true;
}

LinearSolverResult SparseCholeskySolver::Prepare(const SchurOperator& S) {
  LinearSolverResult result;
  Analyze(S.layout());
  factor_.resize(Index(factor_size_));
  stack_.resize(Index(stack_size_));
  front_.resize(Index(front_size_));
  x_local_.resize(Index(local_size_));
  for (const Supernode& node : nodes_) {
    if (!FactorFront(S, node, &result.failed_pivot)) return result;
  }
  result.ok = true;
  return result;
}

LinearSolverResult SparseCholeskySolver::Solve(const SchurOperator& S, const double* b, double* x,
                                               const SolveRequest&) {
  LinearSolverResult result;
  const SchurLayout& layout = S.layout();
  const kernels::KernelTable& kernel = kernels::Kernels();
  std::copy_n(b, layout.size(), x);
  // Gathers the front's part of x and scatters it back; first: from this block of the front on.
  const auto gather = [&](const Supernode& node) {
    for (std::int32_t k = node.block_begin; k < node.block_end; ++k) {
      const int block = front_blocks_[Index(k)];
      std::copy_n(x + layout.offsets[Index(block)], layout.Dim(block),
                  x_local_.data() + block_offset_[Index(k)]);
    }
  };
  const auto scatter = [&](const Supernode& node, std::int32_t count) {
    for (std::int32_t k = node.block_begin; k < node.block_begin + count; ++k) {
      const int block = front_blocks_[Index(k)];
      std::copy_n(x_local_.data() + block_offset_[Index(k)], layout.Dim(block),
                  x + layout.offsets[Index(block)]);
    }
  };
  for (const Supernode& node : nodes_) {
    gather(node);
    kernel.forward_solve_partial(node.size, node.cols, factor_.data() + node.factor, node.stride,
                                 x_local_.data());
    scatter(node, node.block_end - node.block_begin);
  }
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    gather(*node);
    kernel.backward_solve_partial(node->size, node->cols, factor_.data() + node->factor,
                                  node->stride, x_local_.data());
    scatter(*node, node->num_own);
  }
  result.ok = true;
  return result;
}

}  // namespace glissade
