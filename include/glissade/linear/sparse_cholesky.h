// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/linear/fill_order.h"
#include "glissade/linear/linear_solver.h"

namespace glissade {

/// Multifrontal Cholesky of a block sparse S. Blocks are ordered (linear/fill_order.h), merged into
/// supernodes, and each supernode is eliminated in one dense front (Duff and Reid 1983; Liu 1992).
/// The symbolic part is kept while the pattern stays.
///
/// For windows, tens to a few hundred vertices that see only their neighbours, and speed-and-bias
/// chains, as well as for the thousands of cameras of a large bundle adjustment. A dense
/// factorization is faster where most blocks are there anyway: FlopRatio() tells; how large this
/// one is, Flops() and MemoryBytes().
class SparseCholeskySolver final : public LinearSolver {
 public:
  void UseThreads(ThreadPool* threads) override { threads_ = threads; }
  [[nodiscard]] SchurForm Form(const SchurLayout&) override { return SchurForm::kBlocks; }
  LinearSolverResult Prepare(const SchurOperator& S) override;
  LinearSolverResult Solve(const SchurOperator& S, const double* b, double* x,
                           const SolveRequest& request) override;

  /// Analyzes the layout (all blocks) if it has changed since the last call.
  void Analyze(const SchurLayout& layout);
  /// Operations of this factorization relative to a dense one, after Analyze.
  [[nodiscard]] double FlopRatio() const { return flop_ratio_; }
  /// Whether the last Analyze was of this layout.
  [[nodiscard]] bool IsOf(const SchurLayout& layout) const { return version_ == layout.version; }
  /// Multiplications of a factorization, after Analyze.
  [[nodiscard]] double Flops() const { return flops_; }
  /// Memory of the numbers of a factorization, fronts included, after Analyze.
  [[nodiscard]] std::int64_t MemoryBytes() const { return memory_bytes_; }

 private:
  /// Blocks that are eliminated together, and the front they are eliminated in.
  struct Supernode {
    std::int32_t block_begin = 0, block_end = 0;  // in front_blocks_: own blocks first, then rows
    std::int32_t num_own = 0;
    std::int32_t zeros = 0;  // explicit zeros that merging brought in
    std::int32_t cols = 0;   // scalar columns eliminated here
    std::int32_t size = 0;   // scalar size of the front
    std::int32_t stride = 0;
    std::int64_t factor = 0;                      // offset of [L11; L21] (or the front) in factor_
    std::int64_t update = 0;                      // offset of the Schur complement in the stack
    std::int32_t entry_begin = 0, entry_end = 0;  // entries_: blocks of S that start here
    std::int32_t child_begin = 0, child_end = 0;  // children_
    std::int32_t parent = -1;
    std::int32_t map_begin = 0;  // parent_offset_: one per row block
  };
  /// A block of S: which it is, and where it goes in the front.
  struct Entry {
    std::int32_t block;  // in SchurLayout::blocks
    std::int32_t rows, cols;
    std::int32_t front_row, front_col;  // scalar, in the front
    bool transposed;                    // stored in S the other way round
  };

  void FindColumns(const SchurLayout& layout);
  void BuildSupernodes(const SchurLayout& layout);
  void SortPostorder();
  void LayOut(const SchurLayout& layout);
  void ListEntries(const SchurLayout& layout);
  bool FactorFront(const SchurOperator& S, const Supernode& node, int* failed_pivot);
  [[nodiscard]] std::int32_t OffsetInFront(const Supernode& node, std::int32_t block) const;

  std::uint64_t version_ = 0;  // of the layout that was analyzed
  double flop_ratio_ = 1.0, flops_ = 0.0;
  std::int64_t factor_size_ = 0, stack_size_ = 0, front_size_ = 0, local_size_ = 0;
  std::int64_t memory_bytes_ = 0;
  ThreadPool* threads_ = nullptr;
  bool in_place_ = false;                   // fronts stay where they are factored
  std::vector<Supernode> nodes_;            // children before parents
  std::vector<std::int32_t> front_blocks_;  // blocks of each front, in elimination order
  std::vector<std::int32_t> block_offset_;  // scalar offset of each of them in its front
  std::vector<std::int32_t> children_;
  std::vector<std::int32_t> parent_offset_;  // scalar offset of each row block in the parent front
  std::vector<Entry> entries_;
  std::vector<double> factor_, front_, stack_, x_local_, scratch_;

  // Symbolic scratch.
  FillOrder fill_order_;
  std::vector<std::int32_t> order_, position_, node_of_block_, local_;
  std::vector<std::int32_t> next_own_, head_, top_, begin_;
  /// By block: those that are eliminated later and have an entry in its column of the factor, in
  /// the order of elimination.
  std::vector<std::vector<std::int32_t>> column_;
  std::vector<std::int32_t> first_waiting_, next_waiting_;  // supernodes by the block they wait for
  std::vector<Supernode> sorted_nodes_;
};

}  // namespace glissade
