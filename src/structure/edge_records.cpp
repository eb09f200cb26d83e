// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Records of edges and landmarks (graph/edge_plan.h): where each reads and adds.

#include <algorithm>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/structure/structure.h"
#include "structure/inactive.h"

namespace glissade {

namespace {
using internal::Index;
}  // namespace

void Structure::LayOutLandmark(int landmark) {
  LandmarkBlock& block = landmarks_[Index(landmark)];
  block.record = landmark_buffer_size_;
  landmark_records_.push_back(block.record);
  block.slot_begin = static_cast<std::int32_t>(slot_block_.size());
  for (int k = landmark_edges_begin_[Index(landmark)];
       k < landmark_edges_begin_[Index(landmark) + 1]; ++k) {
    const EdgeRef& ref = landmark_edges_[Index(k)];
    const FlatEdges& edges = flat_[Index(ref.pool)];
    const int begin = edges.Begin(ref.edge);
    for (int i = 0; i < edges.Arity(ref.edge); ++i) {
      const std::int32_t v = edges.variable[Index(begin + i)];
      if (v >= 0 && stamp_of_block_[Index(v)] != landmark) {
        stamp_of_block_[Index(v)] = landmark;
        slot_block_.push_back(v);
      }
    }
  }
  block.slot_end = static_cast<std::int32_t>(slot_block_.size());
  std::sort(slot_block_.begin() + block.slot_begin, slot_block_.begin() + block.slot_end);
  std::int64_t offset = landmark_buffer_size_ + block.dim * block.dim + block.dim;
  for (std::int32_t s = block.slot_begin; s < block.slot_end; ++s) {
    const PoseBlock& pose = poses_[Index(slot_block_[Index(s)])];
    slot_row_.push_back(pose.offset);
    slot_dim_.push_back(pose.dim);
    slot_of_block_[Index(slot_block_[Index(s)])] = static_cast<std::int32_t>(offset - block.record);
    offset += pose.dim * block.dim;
  }
  landmark_buffer_size_ = offset;
}

void Structure::WriteEdge(const EdgeRef& ref, int landmark) {
  const FlatEdges& edges = flat_[Index(ref.pool)];
  const int arity = edges.Arity(ref.edge);
  const std::int32_t* variable = edges.variable.data() + edges.Begin(ref.edge);
  std::int32_t* w = WriteWords(ref);
  if (landmark >= 0) w[plan::kLandmarkIndex] = landmark;
  for (int i = 0; i < arity; ++i) {
    const std::int32_t v = variable[i];
    if (v < 0) continue;
    if (landmark >= 0) w[plan::WBlock(arity, i)] = slot_of_block_[Index(v)];
    for (int j = 0; j <= i; ++j) {
      const std::int32_t u = variable[j];
      if (u < 0) continue;
      w[plan::HBlock(arity, plan::Pair(i, j))] =
          v >= u ? PairOffset(v, u) : plan::Transposed(PairOffset(u, v));
    }
  }
}

// Appends the record of an edge: where its vertices are and where b goes.
std::int32_t* Structure::WriteWords(const EdgeRef& ref) {
  const FlatEdges& edges = flat_[Index(ref.pool)];
  const int arity = edges.Arity(ref.edge);
  const std::int32_t* index = edges.index.data() + edges.Begin(ref.edge);
  const std::int32_t* variable = edges.variable.data() + edges.Begin(ref.edge);
  std::vector<std::int32_t>& words = words_[Index(ref.pool)];
  const std::size_t base = words.size();
  words.resize(base + Index(plan::NumWords(arity)), plan::kNone);
  std::int32_t* w = words.data() + base;
  w[plan::kEdge] = ref.edge;
  for (int i = 0; i < arity; ++i) {
    const std::int32_t v = variable[i];
    w[plan::State(i)] = index[i];
    if (v == kInactive) continue;
    w[plan::Target(arity, i)] = v < 0 ? plan::kLandmark : poses_[Index(v)].offset;
  }
  return w;
}

// At the end of the last chunk: their records have no blocks of H.
void Structure::WriteConstantEdges(std::int32_t pool_id, const DynamicEdgePool& pool) {
  EdgeRun& run = runs_[Index(num_chunks_ - 1) * num_pools_ + Index(pool_id)];
  const FlatEdges& edges = flat_[Index(pool_id)];
  for (std::size_t k = 0; k < constant_edges_.size(); ++k) {
    const std::int32_t edge = constant_edges_[k];
    WriteWords({pool_id, edge});
    ++run.count;
    const std::int32_t* variable = edges.variable.data() + edges.Begin(edge);
    int row = 0;
    for (int i = 0; i < edges.Arity(edge); ++i) {
      int col = 0;
      for (int j = 0; j <= i; ++j) {
        const std::int32_t v = variable[i], u = variable[j];
        if (v >= 0 && u >= 0) {
          const bool swapped = v < u;
          constant_blocks_.push_back({static_cast<std::int32_t>(k),
                                      swapped ? PairIndex(u, v) : PairIndex(v, u),
                                      swapped ? col : row, swapped ? row : col});
        }
        col += pool.vertex_pool(edge, j)->ops().tangent_dim;
      }
      row += pool.vertex_pool(edge, i)->ops().tangent_dim;
    }
  }
}

std::int32_t Structure::PairIndex(std::int32_t row, std::int32_t col) {
  if (2 * (h_blocks_.size() + 1) > pair_table_.size()) GrowPairTable();
  const std::size_t mask = pair_table_.size() - 1;
  const std::uint64_t key =
      (static_cast<std::uint64_t>(row) << 32) | static_cast<std::uint32_t>(col);
  std::size_t slot = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ull) >> 32) & mask;
  for (;; slot = (slot + 1) & mask) {
    const std::int32_t found = pair_table_[slot];
    if (found < 0) break;
    const PoseBlockPair& pair = h_blocks_[Index(found)];
    if (pair.row == row && pair.col == col) return found;
  }
  pair_table_[slot] = static_cast<std::int32_t>(h_blocks_.size());
  h_blocks_.push_back({row, col, static_cast<std::int32_t>(h_size_)});
  h_size_ += std::int64_t{poses_[Index(row)].dim} * poses_[Index(col)].dim;
  return static_cast<std::int32_t>(h_blocks_.size()) - 1;
}

void Structure::GrowPairTable() {
  const std::size_t size = std::max<std::size_t>(256, 2 * pair_table_.size());
  pair_table_.assign(size, -1);
  const std::size_t mask = size - 1;
  for (std::size_t k = 0; k < h_blocks_.size(); ++k) {
    const std::uint64_t key = (static_cast<std::uint64_t>(h_blocks_[k].row) << 32) |
                              static_cast<std::uint32_t>(h_blocks_[k].col);
    std::size_t slot = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ull) >> 32) & mask;
    while (pair_table_[slot] >= 0)
      slot = (slot + 1) & mask;
    pair_table_[slot] = static_cast<std::int32_t>(k);
  }
}

}  // namespace glissade
