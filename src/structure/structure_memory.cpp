// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What an analysis takes, and how a large problem gives it back.

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/structure/structure.h"

namespace glissade {

namespace {

using internal::Index;

template <class T>
void Free(std::vector<T>* v) {
  std::vector<T>().swap(*v);
}

template <class T>
std::int64_t Bytes(const std::vector<T>& v) {
  return static_cast<std::int64_t>(v.capacity() * sizeof(T));
}

template <class T>
std::int64_t Bytes(const std::vector<std::vector<T>>& lists) {
  std::int64_t sum = 0;
  for (const std::vector<T>& list : lists)
    sum += Bytes(list);
  return sum;
}

}  // namespace

void Structure::ReleaseScratch(const std::vector<bool>& in_runs) {
  if (!IsLarge()) return;
  for (std::size_t p = 0; p < words_.size() && p < in_runs.size(); ++p) {
    if (!in_runs[p] || words_[p].empty()) continue;
    Free(&words_[p]);
    has_records_ = false;
  }
  Free(&variable_);
  Free(&touched_);
  Free(&flat_);
  Free(&landmark_edges_);
  Free(&landmark_edges_begin_);
  Free(&order_);
  Free(&unsorted_);
  Free(&duplicate_table_);
  Free(&grouped_);
  for (auto* list : {&fill_, &new_number_, &edges_of_pose_, &column_begin_, &column_rows_,
                     &seen_begin_, &seen_landmarks_, &observer_, &newest_run_, &next_run_,
                     &first_edge_, &run_of_edge_, &moved_pair_, &group_of_host_, &pair_of_pose_,
                     &frames_, &last_lanes_, &chain_of_row_, &next_in_row_})
    Free(list);
  Free(&is_grouped_);
  for (auto* list : {&slot_block_, &slot_row_, &slot_dim_})
    list->shrink_to_fit();
  landmark_records_.shrink_to_fit();
  reduced_pattern_.shrink_to_fit();
}

std::int64_t Structure::MemoryBytes() const {
  return Bytes(poses_) + Bytes(pose_offsets_) + Bytes(landmarks_) + Bytes(h_blocks_) +
         Bytes(reduced_pattern_) + Bytes(landmark_records_) + Bytes(slot_block_) +
         Bytes(slot_row_) + Bytes(slot_dim_) + Bytes(words_) + Bytes(step_offsets_) +
         Bytes(pair_table_) + Bytes(plan_.landmark_of_lane);
}

std::int64_t Structure::AnalysisBytes(const Graph& graph) {
  constexpr std::int64_t kWord = sizeof(std::int32_t);
  std::int64_t bytes = 0;
  for (const auto& pool : graph.edge_pools()) {
    const std::int64_t arity = pool->fixed_arity(), count = pool->size();
    // Indices and variables; the record; the lists by landmark and of slots.
    if (arity > 0) {
      bytes += count * kWord *
               (2 * arity + plan::NumWords(static_cast<int>(arity)) + 3 + 3 * (arity - 1));
    }
  }
  for (const auto& pool : graph.vertex_pools())
    bytes += std::int64_t{pool->size()} * 2 * kWord;
  return bytes;
}

}  // namespace glissade
