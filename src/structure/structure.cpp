// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/structure/structure.h"

#include <algorithm>
#include <atomic>
#include <limits>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "structure/inactive.h"

namespace glissade {

namespace {

constexpr int kMaxChunks = 8;  // each chunk has its own copy of H_pp and S

using internal::Index;

/// What is kept from one analysis to the next (a symbolic factorization, say) is told by this
/// number whether it still holds, also where it has served another problem in between.
std::uint64_t NewAnalysis() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

Status Structure::Analyze(Graph* graph, const StructureOptions& options) {
  const bool must_check = !checked_duplicates_ && !options.allow_duplicate_observations;
  if (IsCurrent(*graph) && !must_check && (has_records_ || !options.needs_records) &&
      groups_landmarks_ == options.group_landmarks &&
      Reach(*graph) <= 2.0 * std::max(plan_.reach, LandmarkPlan::kMaxReach)) {
    return {};
  }
  graph_ = analysis_ = 0;
  graph->Compact();
  num_pools_ = graph->edge_pools().size();
  words_.resize(num_pools_);
  for (auto& words : words_)
    words.clear();
  for (const auto& pool : graph->edge_pools())
    pool->Prepare();

  FlattenEdges(*graph);
  if (!options.allow_duplicate_observations) {
    if (Status status = FindDuplicates(*graph); !status.ok()) return status;
  }
  checked_duplicates_ = !options.allow_duplicate_observations;
  NumberVariables(*graph);
  SortLandmarks();
  ListLandmarkEdges(*graph);
  groups_landmarks_ = options.group_landmarks;
  PlanGroups(*graph, groups_landmarks_);
  NumberLandmarkSteps();
  CutIntoChunks();

  // Pose blocks always have their diagonal; pairs are added as edges bring them in.
  h_blocks_.clear();
  h_size_ = 0;
  std::fill(pair_table_.begin(), pair_table_.end(), -1);
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    const auto block = static_cast<std::int32_t>(k);
    poses_[k].h_diagonal = PairOffset(block, block);
  }

  slot_block_.clear();
  slot_row_.clear();
  slot_dim_.clear();
  landmark_records_.clear();
  landmark_buffer_size_ = 0;
  slot_of_block_.assign(poses_.size(), 0);
  stamp_of_block_.assign(poses_.size(), -1);
  runs_.assign(Index(num_chunks_) * num_pools_, {});

  const int num_landmarks = static_cast<int>(landmarks_.size());
  const auto free_begin = landmark_edges_begin_[Index(num_landmarks)];
  const auto num_without = static_cast<std::int32_t>(landmark_edges_.size()) - free_begin;
  // Without first estimates even a linear edge has a Jacobian that varies with its boxminus.
  constant_edges_.clear();
  constant_blocks_.clear();
  std::int32_t linear_id = -1;
  for (std::size_t p = 0; p < num_pools_; ++p) {
    if (graph->edge_pools()[p]->type() == &kTypeInfo<DynamicEdge> &&
        graph->first_estimates() != FirstEstimates::kOff) {
      linear_id = static_cast<std::int32_t>(p);
    }
  }
  const auto* linear =
      linear_id < 0
          ? nullptr
          : static_cast<const DynamicEdgePool*>(graph->edge_pools()[Index(linear_id)].get());
  for (int chunk = 0; chunk < num_chunks_; ++chunk) {
    EdgeRun* runs = runs_.data() + Index(chunk) * num_pools_;
    for (std::size_t p = 0; p < num_pools_; ++p) {
      runs[p] = {static_cast<std::int32_t>(p), 0, static_cast<std::int64_t>(words_[p].size())};
    }
    for (int l = landmark_chunks_[Index(chunk)]; l < landmark_chunks_[Index(chunk) + 1]; ++l) {
      LayOutLandmark(l);
      for (int k = landmark_edges_begin_[Index(l)]; k < landmark_edges_begin_[Index(l) + 1]; ++k) {
        const EdgeRef& ref = landmark_edges_[Index(k)];
        WriteEdge(ref, l);
        ++runs[ref.pool].count;
      }
    }
    const auto part = [&](int c) {
      return free_begin + static_cast<std::int32_t>(std::int64_t{num_without} * c / num_chunks_);
    };
    for (int k = part(chunk); k < part(chunk + 1); ++k) {
      const EdgeRef& ref = landmark_edges_[Index(k)];
      if (ref.pool == linear_id && linear->At(ref.edge).ConstantHessian() != nullptr) {
        constant_edges_.push_back(ref.edge);
        continue;
      }
      WriteEdge(ref, -1);
      ++runs[ref.pool].count;
    }
  }
  FinishPlan();
  num_varying_ = h_blocks_.size();
  varying_size_ = h_size_;
  if (linear != nullptr) WriteConstantEdges(linear_id, *linear);
  if (Status status = CheckSize(*graph); !status.ok()) return status;
  BuildReducedPattern();
  has_records_ = true;
  analysis_ = NewAnalysis();
  graph_ = graph->identity();
  version_ = graph->structure_version();
  return {};
}

void Structure::FlattenEdges(const Graph& graph) {
  flat_.resize(num_pools_);
  for (std::size_t p = 0; p < num_pools_; ++p) {
    const EdgePoolBase& pool = *graph.edge_pools()[p];
    FlatEdges& edges = flat_[p];
    const int count = pool.size();
    edges.pool.clear();
    edges.begin.clear();
    edges.arity = pool.fixed_arity();
    if (edges.arity > 0) {
      for (int i = 0; i < edges.arity; ++i)
        edges.pool.push_back(pool.vertex_pool(0, i)->id());
      edges.index.resize(Index(count) * Index(edges.arity));
    } else {
      edges.begin.push_back(0);
      for (int edge = 0; edge < count; ++edge) {
        for (int i = 0; i < pool.arity(edge); ++i) {
          edges.pool.push_back(pool.vertex_pool(edge, i)->id());
        }
        edges.begin.push_back(static_cast<std::int32_t>(edges.pool.size()));
      }
      edges.index.resize(edges.pool.size());
    }
    pool.AllDenseIndices(edges.index.data());
  }
}

void Structure::ListLandmarkEdges(const Graph& graph) {
  // Counting sort of all edges by landmark; stable, so in insertion order within a landmark.
  const std::size_t num_landmarks = landmarks_.size();
  landmark_edges_begin_.assign(num_landmarks + 2, 0);
  num_edges_ = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t p = 0; p < num_pools_; ++p) {
      const FlatEdges& edges = flat_[p];
      const int count = graph.edge_pools()[p]->size();
      for (int edge = 0; edge < count; ++edge) {
        std::size_t bucket = num_landmarks;
        const std::int32_t* v = edges.variable.data() + edges.Begin(edge);
        for (int i = 0; i < edges.Arity(edge); ++i) {
          if (v[i] < 0 && v[i] != kInactive) bucket = Index(~v[i]);
        }
        if (pass == 0) {
          ++landmark_edges_begin_[bucket + 1];
          ++num_edges_;
        } else {
          landmark_edges_[Index(fill_[bucket]++)] = {static_cast<std::int32_t>(p), edge};
        }
      }
    }
    if (pass == 0) {
      for (std::size_t l = 0; l <= num_landmarks; ++l) {
        landmark_edges_begin_[l + 1] += landmark_edges_begin_[l];
      }
      landmark_edges_.resize(Index(num_edges_));
      fill_.assign(landmark_edges_begin_.begin(), landmark_edges_begin_.end());
    }
  }
}

void Structure::CutIntoChunks() {
  // An even number, so that two threads end together. With fewer edges in each, handing work to a
  // thread costs more than it saves.
  const int chunks = num_edges_ / kEdgesPerChunk;
  num_chunks_ = std::clamp(chunks > 1 ? chunks + chunks % 2 : 1, 1, kMaxChunks);
  // Cut where the edges are shared out evenly.
  const int num_landmarks = static_cast<int>(landmarks_.size());
  const std::int64_t total = landmark_edges_begin_[Index(num_landmarks)];
  landmark_chunks_.clear();
  landmark_chunks_.push_back(0);
  int l = 0;
  for (int c = 1; c < num_chunks_; ++c) {
    while (l < num_landmarks && landmark_edges_begin_[Index(l)] < total * c / num_chunks_)
      ++l;
    landmark_chunks_.push_back(l);
  }
  landmark_chunks_.push_back(num_landmarks);
}

Status Structure::CheckSize(const Graph& graph) const {
  constexpr std::int64_t kLimit = std::numeric_limits<std::int32_t>::max();
  if (h_size_ > kLimit) {
    return {StatusCode::kInvalidArgument,
            "problem too large: more than 2^31 numbers in the poses' part of H"};
  }
  constexpr std::int32_t kMaxSlots = std::numeric_limits<std::uint16_t>::max();
  for (const LandmarkBlock& landmark : landmarks_) {
    if (landmark.slot_end - landmark.slot_begin <= kMaxSlots) continue;
    const AnyVertex vertex = graph.vertex_pools()[Index(landmark.pool)]->HandleAt(landmark.index);
    return {StatusCode::kInvalidArgument,
            "landmark " + ToString(vertex) + " is seen by more than 65535 vertices", vertex};
  }
  return {};
}

}  // namespace glissade
