// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The symbolic part of SparseCholeskySolver after the order: supernodes, fronts, and where all
// goes.

#include <algorithm>

#include "glissade/linear/sparse_cholesky.h"

#include "glissade/base/index.h"

namespace glissade {

namespace {
using internal::Index;

constexpr double kMaxZeros = 0.35;  // part of a front's own columns that may be explicit zeros
constexpr std::int64_t kMaxInPlace = 64 * 1024;  // doubles
}  // namespace

void SparseCholeskySolver::Analyze(const SchurLayout& layout) {
  if (version_ == layout.version) return;
  version_ = 0;
  fill_order_.Find(layout, &order_);
  FindColumns(layout);
  BuildSupernodes(layout);
  SortPostorder();
  LayOut(layout);
  ListEntries(layout);
  version_ = layout.version;
}

// The columns of the factor: what S has there, and what the columns bring that have their first
// block below the diagonal there (George and Liu 1981, Sec. 5.4).
void SparseCholeskySolver::FindColumns(const SchurLayout& layout) {
  const std::size_t n = layout.num_vertices();
  position_.resize(n);
  for (std::size_t k = 0; k < n; ++k)
    position_[Index(order_[k])] = static_cast<std::int32_t>(k);
  column_.resize(std::max(column_.size(), n));
  for (std::size_t k = 0; k < n; ++k)
    column_[k].clear();
  for (const BlockIndex& block : layout.blocks) {
    if (block.row == block.col) continue;
    const bool row_first = position_[Index(block.row)] < position_[Index(block.col)];
    column_[Index(row_first ? block.row : block.col)].push_back(row_first ? block.col : block.row);
  }
  first_waiting_.assign(n, -1);  // columns by their first block
  next_waiting_.assign(n, -1);
  local_.assign(n, -1);
  for (const std::int32_t block : order_) {
    std::vector<std::int32_t>& column = column_[Index(block)];
    local_[Index(block)] = block;
    for (const std::int32_t row : column)
      local_[Index(row)] = block;
    for (std::int32_t child = first_waiting_[Index(block)]; child >= 0;
         child = next_waiting_[Index(child)]) {
      for (const std::int32_t row : column_[Index(child)]) {
        if (local_[Index(row)] == block) continue;
        local_[Index(row)] = block;
        column.push_back(row);
      }
    }
    std::sort(column.begin(), column.end(), [&](std::int32_t a, std::int32_t b) {
      return position_[Index(a)] < position_[Index(b)];
    });
    if (column.empty()) continue;
    next_waiting_[Index(block)] = first_waiting_[Index(column.front())];
    first_waiting_[Index(column.front())] = block;
  }
}

// A block joins the supernode of its child where that brings few explicit zeros.
void SparseCholeskySolver::BuildSupernodes(const SchurLayout& layout) {
  const std::size_t n = layout.num_vertices();
  nodes_.clear();
  front_blocks_.clear();
  node_of_block_.assign(n, -1);
  next_own_.assign(n, -1);
  head_.clear();
  top_.clear();
  local_.resize(n);  // scalars of each column
  for (std::size_t block = 0; block < n; ++block) {
    local_[block] = 0;
    for (const std::int32_t other : column_[block])
      local_[block] += layout.Dim(other);
  }
  // Supernodes by the block that their last column's first block is, in the order of their numbers.
  first_waiting_.assign(n, -1);
  next_waiting_.clear();
  const auto wait = [&](std::int32_t node, std::int32_t block) {
    std::int32_t* at = &first_waiting_[Index(block)];
    while (*at >= 0 && *at < node)
      at = &next_waiting_[Index(*at)];
    next_waiting_[Index(node)] = *at;
    *at = node;
  };
  for (const std::int32_t block : order_) {
    const int dim = layout.Dim(block);
    const int size = dim + local_[Index(block)];
    std::int32_t best = -1;
    int best_zeros = 0;
    for (std::int32_t s = first_waiting_[Index(block)]; s >= 0; s = next_waiting_[Index(s)]) {
      const int cols = nodes_[Index(s)].cols;
      const int zeros = cols * (size - local_[Index(top_[Index(s)])]);
      // Fewer fronts are worth some zeros, but those add up: all of the front's count.
      const int all_zeros = nodes_[Index(s)].zeros + zeros;
      const double most = kMaxZeros * double(cols + dim) * size;
      if (all_zeros <= most && (best < 0 || zeros < best_zeros)) {
        best = s;
        best_zeros = zeros;
      }
    }
    if (best < 0) {
      best = static_cast<std::int32_t>(nodes_.size());
      nodes_.emplace_back();
      next_waiting_.push_back(-1);
      head_.push_back(block);
      top_.push_back(block);
    } else {
      next_own_[Index(top_[Index(best)])] = block;
      top_[Index(best)] = block;
    }
    nodes_[Index(best)].cols += dim;
    nodes_[Index(best)].zeros += best_zeros;
    node_of_block_[Index(block)] = best;
    const auto& column = column_[Index(block)];
    if (!column.empty()) wait(best, column.front());
  }
  for (std::size_t s = 0; s < nodes_.size(); ++s) {
    Supernode& node = nodes_[s];
    node.block_begin = static_cast<std::int32_t>(front_blocks_.size());
    for (std::int32_t b = head_[s]; b >= 0; b = next_own_[Index(b)])
      front_blocks_.push_back(b);
    node.num_own = static_cast<std::int32_t>(front_blocks_.size()) - node.block_begin;
    const auto& rows = column_[Index(top_[s])];
    front_blocks_.insert(front_blocks_.end(), rows.begin(), rows.end());
    node.block_end = static_cast<std::int32_t>(front_blocks_.size());
    node.parent = rows.empty() ? -1 : node_of_block_[Index(rows.front())];
  }
}

void SparseCholeskySolver::SortPostorder() {
  // Depth first from the roots, so that the updates of a node's children are on top of the stack.
  // Children of node s: children_[child_begin, child_end), by counting; roots hang under node n.
  const std::size_t n = nodes_.size();
  const auto parent_of = [&](std::size_t s) {
    return nodes_[s].parent < 0 ? n : Index(nodes_[s].parent);
  };
  begin_.assign(n + 2, 0);
  for (std::size_t s = 0; s < n; ++s)
    ++begin_[parent_of(s) + 1];
  for (std::size_t s = 0; s <= n; ++s)
    begin_[s + 1] += begin_[s];
  children_.resize(n);
  head_.assign(begin_.begin(), begin_.end());
  for (std::size_t s = 0; s < n; ++s) {
    children_[Index(head_[parent_of(s)]++)] = static_cast<std::int32_t>(s);
  }
  top_.clear();  // the stack of the search; ~s: node s whose children are done
  local_.clear();
  for (std::int32_t k = begin_[n + 1]; k-- > begin_[n];)
    top_.push_back(children_[Index(k)]);
  while (!top_.empty()) {
    const std::int32_t s = top_.back();
    top_.pop_back();
    if (s < 0) {
      local_.push_back(~s);
      continue;
    }
    top_.push_back(~s);
    for (std::int32_t k = begin_[Index(s) + 1]; k-- > begin_[Index(s)];) {
      top_.push_back(children_[Index(k)]);
    }
  }
  head_.resize(n);  // rank of each node
  for (std::size_t k = 0; k < n; ++k)
    head_[Index(local_[k])] = static_cast<std::int32_t>(k);
  sorted_nodes_.clear();
  for (const std::int32_t s : local_) {
    Supernode node = nodes_[Index(s)];
    if (node.parent >= 0) node.parent = head_[Index(node.parent)];
    node.child_begin = begin_[Index(s)];
    node.child_end = begin_[Index(s) + 1];
    sorted_nodes_.push_back(node);
  }
  nodes_.swap(sorted_nodes_);
  for (std::int32_t& child : children_)
    child = head_[Index(child)];
  for (std::int32_t& node : node_of_block_)
    node = head_[Index(node)];
}

void SparseCholeskySolver::LayOut(const SchurLayout& layout) {
  block_offset_.resize(front_blocks_.size());
  std::int64_t factor = 0;
  std::int64_t top = 0, stack_size = 0;
  int largest = 0;
  double flops = 0.0;
  for (Supernode& node : nodes_) {
    int offset = 0;
    for (std::int32_t k = node.block_begin; k < node.block_end; ++k) {
      if (k == node.block_begin + node.num_own) node.cols = offset;
      block_offset_[Index(k)] = offset;
      offset += layout.Dim(front_blocks_[Index(k)]);
    }
    if (node.block_end == node.block_begin + node.num_own) node.cols = offset;
    node.size = offset;
    node.stride = (offset + 7) / 8 * 8;
    node.factor = factor;
    factor += std::int64_t{node.stride} * node.cols;
    // Pop the children, push the own update.
    for (std::int32_t c = node.child_begin; c < node.child_end; ++c) {
      top = std::min(top, nodes_[Index(children_[Index(c)])].update);
    }
    node.update = top;
    const std::int64_t rows = node.size - node.cols;
    top += rows * rows;
    stack_size = std::max(stack_size, top);
    largest = std::max(largest, node.size);
    for (int c = 0; c < node.cols; ++c)
      flops += double(node.size - c) * (node.size - c);
  }
  // Whole fronts are kept where they fit the second-level cache: what they pass on to their parents
  // is then read where it was made.
  std::int64_t fronts = 0;
  for (const Supernode& node : nodes_)
    fronts += std::int64_t{node.stride} * node.size;
  in_place_ = fronts <= kMaxInPlace;
  if (in_place_) {
    factor = stack_size = 0;
    for (Supernode& node : nodes_) {
      node.factor = factor;
      factor += std::int64_t{node.stride} * node.size;
    }
  }
  // A child's update must outlive the assembly of its parent's front only, but siblings' are below
  // each other on the stack, and the parent's own goes where the lowest of them was.
  const std::int64_t stride = (largest + 7) / 8 * 8;
  factor_size_ = factor;
  stack_size_ = stack_size;
  front_size_ = in_place_ ? 0 : stride * largest;
  local_size_ = stride;
  constexpr std::int64_t kDouble = sizeof(double);
  memory_bytes_ = kDouble * (factor_size_ + stack_size_ + front_size_) +
                  static_cast<std::int64_t>(layout.blocks.size() * sizeof(Entry) +
                                            front_blocks_.size() * 5 * sizeof(std::int32_t));
  const auto n = static_cast<double>(layout.size());
  flops_ = flops;
  flop_ratio_ = n > 0.0 ? flops / (n * n * n / 3.0) : 1.0;

  // Where the row blocks of each node lie in its parent's front.
  parent_offset_.clear();
  for (Supernode& node : nodes_) {
    node.map_begin = static_cast<std::int32_t>(parent_offset_.size());
    if (node.parent < 0) continue;
    const Supernode& parent = nodes_[Index(node.parent)];
    for (std::int32_t k = node.block_begin + node.num_own; k < node.block_end; ++k) {
      parent_offset_.push_back(OffsetInFront(parent, front_blocks_[Index(k)]));
    }
  }
}

void SparseCholeskySolver::ListEntries(const SchurLayout& layout) {
  // Each block of S goes to the node of its earlier block: a counting sort.
  const auto node_of = [&](const BlockIndex& block) {
    const bool row_first = position_[Index(block.row)] < position_[Index(block.col)];
    return Index(node_of_block_[Index(row_first ? block.row : block.col)]);
  };
  begin_.assign(nodes_.size() + 1, 0);
  for (const BlockIndex& block : layout.blocks)
    ++begin_[node_of(block) + 1];
  for (std::size_t s = 0; s < nodes_.size(); ++s) {
    begin_[s + 1] += begin_[s];
    nodes_[s].entry_begin = begin_[s];
    nodes_[s].entry_end = begin_[s + 1];
  }
  entries_.resize(layout.blocks.size());
  for (std::size_t k = 0; k < layout.blocks.size(); ++k) {
    const BlockIndex block = layout.blocks[k];
    const bool transposed = position_[Index(block.row)] < position_[Index(block.col)];
    const std::size_t s = node_of(block);
    const std::int32_t row = OffsetInFront(nodes_[s], block.row);
    const std::int32_t col = OffsetInFront(nodes_[s], block.col);
    entries_[Index(begin_[s]++)] = {static_cast<std::int32_t>(k), layout.Dim(block.row),
                                    layout.Dim(block.col),        transposed ? col : row,
                                    transposed ? row : col,       transposed};
  }
}

std::int32_t SparseCholeskySolver::OffsetInFront(const Supernode& node, std::int32_t block) const {
  // The front's blocks are in elimination order.
  const auto begin = front_blocks_.begin() + node.block_begin;
  const auto end = front_blocks_.begin() + node.block_end;
  const auto at = std::lower_bound(begin, end, block, [&](std::int32_t a, std::int32_t b) {
    return position_[Index(a)] < position_[Index(b)];
  });
  return block_offset_[Index(at - front_blocks_.begin())];
}

}  // namespace glissade
