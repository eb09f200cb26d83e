// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// How the edges of landmarks are sorted into runs, and where each run reads and adds.

#include <algorithm>

#include "glissade/base/index.h"
#include "kernels/kernels.h"
#include "linear/landmark_runs.h"

namespace glissade {

namespace {

using internal::Index;

/// Values of so many edges stay in the first-level cache while they are used.
constexpr int kMaxRun = 64;
constexpr int kPoseColumns = 6;
/// Edges that are sorted into runs together. Blocks of W of so many observations by cameras of nine
/// parameters fit into the second-level cache.
constexpr int kMaxBatch = 4096;
/// Each sensor costs a pass over the edges of the others.
constexpr int kMaxSorted = 64;

int RoundUp(int lanes) {
  return (lanes + kernels::kLaneBlock - 1) / kernels::kLaneBlock * kernels::kLaneBlock;
}

int LandmarkOf(const std::int32_t* words, int arity) {
  for (int i = 0; i < arity; ++i) {
    if (words[plan::Target(arity, i)] == plan::kLandmark) return i;
  }
  return -1;
}

/// Equal for edges on the same vertices but for the landmark, and in the order of these as long as
/// there are two of them at most.
std::uint64_t KeyOf(const std::int32_t* words, int arity) {
  constexpr std::uint64_t kMix = 0x9E3779B97F4A7C15ull;
  std::uint64_t key = 0;
  int count = 0;
  for (int i = 0; i < arity; ++i) {
    if (words[plan::Target(arity, i)] == plan::kLandmark) continue;
    const auto index = static_cast<std::uint32_t>(words[plan::State(i)]);
    key = count++ < 2 ? (key << 32 | index) : (key ^ index) * kMix;
  }
  return key;
}

bool SameVertices(const std::int32_t* a, const std::int32_t* b, int arity) {
  for (int i = 0; i < arity; ++i) {
    const bool landmark = a[plan::Target(arity, i)] == plan::kLandmark;
    if (landmark != (b[plan::Target(arity, i)] == plan::kLandmark)) return false;
    if (!landmark && a[plan::State(i)] != b[plan::State(i)]) return false;
  }
  return true;
}

}  // namespace

void LandmarkRuns::Plan(const Structure& structure, const Graph& graph) {
  if (analysis_ == structure.analysis()) {
    if (weights_version_ != graph.weights_version()) PlanWeights(graph);
    return;
  }
  analysis_ = structure.analysis();
  const int num_chunks = structure.num_chunks();
  num_pools_ = graph.edge_pools().size();
  taken_.assign(Index(num_chunks) * num_pools_, 0);
  // Of as many chunks and pools: an analysis within a solve.
  if (redone_.size() != taken_.size()) redone_.assign(taken_.size(), 0);
  runs_.clear();
  edge_.clear();
  landmark_.clear();
  record_.clear();
  vertex_.clear();
  h_block_.clear();
  w_.clear();
  chunk_begin_.assign(1, 0);
  added_.clear();
  added_begin_.assign(1, 0);
  adds_to_all_.assign(Index(num_chunks), 0);
  is_written_.assign(Index(structure.landmark_buffer_size()), false);
  max_values_ = max_work_ = max_rows_ = 0;
  for (int chunk = 0; chunk < num_chunks; ++chunk) {
    for (const EdgeRun& edges : structure.EdgesOfChunk(chunk)) {
      const EdgePoolBase& pool = *graph.edge_pools()[Index(edges.pool)];
      const int arity = pool.fixed_arity();
      // Those on a landmark come first.
      const std::int32_t* words = structure.Words(edges);
      if (arity == 0) {
        if (edges.count > 0 && words[plan::kLandmarkIndex] != plan::kNone)
          adds_to_all_[Index(chunk)] = 1;
        continue;
      }
      // Batch by batch: what a batch's runs add to stays in the cache between them.
      std::int32_t taken = 0;
      while (taken < edges.count && words[plan::kLandmarkIndex] != plan::kNone) {
        items_.clear();
        std::int32_t landmark = words[plan::kLandmarkIndex];
        for (; taken < edges.count && words[plan::kLandmarkIndex] != plan::kNone; ++taken) {
          if (words[plan::kLandmarkIndex] != landmark) {
            landmark = words[plan::kLandmarkIndex];
            if (static_cast<int>(items_.size()) >= kMaxBatch) break;
          }
          items_.push_back({KeyOf(words, arity), words});
          words += plan::NumWords(arity);
        }
        PlanPool(pool, edges.pool, arity, structure.landmark_records().data());
      }
      taken_[Index(chunk) * num_pools_ + Index(edges.pool)] = taken;
    }
    chunk_begin_.push_back(static_cast<std::int32_t>(runs_.size()));
    if (adds_to_all_[Index(chunk)] != 0) {
      for (std::int32_t k = chunk_begin_[Index(chunk)]; k < chunk_begin_.back(); ++k)
        runs_[Index(k)].sets = 0;
    }
    added_begin_.push_back(static_cast<std::int32_t>(added_.size()));
  }
  scratch_.resize(std::max(scratch_.size(), Index(num_chunks)));
  for (Scratch& scratch : scratch_) {
    scratch.values.resize(std::max(scratch.values.size(), max_values_));
    scratch.work.resize(std::max(scratch.work.size(), max_work_));
    scratch.factor.resize(kMaxRun);
    scratch.weights.Resize(kMaxRun, max_rows_);
    scratch.states.resize(kMaxRun);
    scratch.points.resize(kMaxRun);
  }
  PlanWeights(graph);
  if (!structure.IsLarge()) return;
  std::vector<Item>().swap(items_);
  std::vector<Item>().swap(rest_);
  std::vector<bool>().swap(is_written_);
  edge_.shrink_to_fit();
  landmark_.shrink_to_fit();
  record_.shrink_to_fit();
  w_.shrink_to_fit();
}

void LandmarkRuns::PlanPool(const EdgePoolBase& pool, int id, int arity,
                            const std::int64_t* records) {
  std::sort(items_.begin(), items_.end());
  const auto edge = [](const Item& item) { return item.words[plan::kEdge]; };
  auto begin = items_.begin();
  while (begin != items_.end()) {
    auto end = begin + 1;
    while (end != items_.end() && SameVertices(begin->words, end->words, arity))
      ++end;
    // By sensor, in the order in which they come; where there are very many, as they come.
    for (int sensors = 0; begin != end; ++sensors) {
      const int first = edge(*begin);
      auto next = std::find_if(
          begin + 1, end, [&](const Item& item) { return !pool.SameInRun(first, edge(item)); });
      if (next != end && sensors < kMaxSorted) {
        rest_.clear();
        auto to = next;
        for (auto from = next; from != end; ++from) {
          if (pool.SameInRun(first, edge(*from))) {
            *to++ = *from;
          } else {
            rest_.push_back(*from);
          }
        }
        std::copy(rest_.begin(), rest_.end(), to);
        next = to;
      }
      for (; begin < next; begin += std::min<std::ptrdiff_t>(kMaxRun, next - begin)) {
        AddRun(pool, id, arity, records, &*begin,
               static_cast<int>(std::min<std::ptrdiff_t>(kMaxRun, next - begin)));
      }
    }
  }
}

void LandmarkRuns::AddRun(const EdgePoolBase& pool, int id, int arity, const std::int64_t* records,
                          const Item* items, int count) {
  const std::int32_t* first = items[0].words;
  Run run;
  run.pool = id;
  run.rows = pool.residual_dim(0);
  run.arity = arity;
  run.landmark = LandmarkOf(first, arity);
  run.count = count;
  run.lanes = RoundUp(count);
  run.lane_begin = static_cast<std::int64_t>(edge_.size());
  run.vertex_begin = static_cast<std::int64_t>(vertex_.size());
  run.pair_begin = static_cast<std::int64_t>(h_block_.size());
  run.w_begin = static_cast<std::int64_t>(w_.size());
  int columns = 1;
  for (int i = 0; i < arity; ++i) {
    const int dim = pool.vertex_pool(0, i)->ops().tangent_dim;
    columns += dim;
    vertex_.push_back(
        {i == run.landmark ? -1 : first[plan::State(i)], dim, first[plan::Target(arity, i)]});
  }
  for (int p = 0; p < plan::NumPairs(arity); ++p)
    h_block_.push_back(first[plan::HBlock(arity, p)]);
  for (int s = 0; s < run.lanes; ++s) {
    const std::int32_t* words = items[std::min(s, count - 1)].words;
    edge_.push_back(words[plan::kEdge]);
    landmark_.push_back(words[plan::State(run.landmark)]);
    record_.push_back(records[words[plan::kLandmarkIndex]]);
  }
  for (int i = 0; i < arity; ++i) {
    if (i == run.landmark) continue;
    for (int s = 0; s < run.lanes; ++s) {
      const std::int32_t block = items[std::min(s, count - 1)].words[plan::WBlock(arity, i)];
      w_.push_back(block != plan::kNone ? record_[Index(run.lane_begin + s)] + block : plan::kNone);
    }
  }
  FindFirst(&run);
  max_rows_ = std::max(max_rows_, Index(run.rows));
  max_values_ = std::max(max_values_, Index(run.rows) * Index(columns) * Index(run.lanes));
  max_work_ = std::max({max_work_, Index(run.rows) * Index(columns),
                        Index(kPoseColumns * run.rows) * Index(run.lanes)});
  runs_.push_back(run);
}

// Which of the run's blocks of W have nothing in them yet: runs add up in the order of this plan. A
// run sets all of its lanes' blocks or none.
void LandmarkRuns::FindFirst(Run* run) {
  for (int i = 0; i < run->arity; ++i) {
    if (i == run->landmark) continue;
    const std::int64_t* w = w_.data() + run->WBegin(i);
    if (w[0] == plan::kNone) continue;
    const std::size_t before = added_.size();
    const std::int32_t size = vertex_[Index(run->vertex_begin + i)].dim *
                              vertex_[Index(run->vertex_begin + run->landmark)].dim;
    for (int s = 0; s < run->count; ++s) {
      if (is_written_[Index(w[s])]) continue;
      is_written_[Index(w[s])] = true;
      added_.push_back({w[s], size});
    }
    if (added_.size() - before != Index(run->count)) continue;
    added_.resize(before);
    run->sets |= 1u << i;
  }
}

void LandmarkRuns::PlanWeights(const Graph& graph) {
  weights_version_ = graph.weights_version();
  weights_.Clear();
  for (Run& run : runs_) {
    run.weights = weights_.Add(*graph.edge_pools()[Index(run.pool)], edge_.data() + run.lane_begin,
                               run.rows, run.count, run.lanes);
  }
}

}  // namespace glissade
