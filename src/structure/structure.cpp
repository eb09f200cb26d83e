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
  if (IsCurrent(*graph) && !must_check && groups_landmarks_ == options.group_landmarks &&
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

void Structure::NumberVariables(const Graph& graph) {
  const auto& pools = graph.vertex_pools();
  variable_.resize(pools.size());
  touched_.resize(pools.size());
  step_offsets_.resize(pools.size());
  for (std::size_t p = 0; p < pools.size(); ++p) {
    variable_[p].assign(Index(pools[p]->size()), kInactive);
    touched_[p].assign(Index(pools[p]->size()), 0);
    step_offsets_[p].assign(Index(pools[p]->size()), -1);
  }
  // A vertex without edges has no information: it is left out rather than made a zero row.
  for (const FlatEdges& edges : flat_) {
    edges.ForEachPool([&](std::size_t pool, std::size_t first, std::size_t step) {
      std::uint8_t* const touched = touched_[pool].data();
      const std::size_t size = edges.index.size();
      for (std::size_t k = first; k < size; k += step)
        touched[edges.index[k]] = 1;
    });
  }
  poses_.clear();
  landmarks_.clear();
  pose_offsets_.assign(1, 0);
  num_landmark_scalars_ = 0;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const VertexPoolBase& pool = *pools[p];
    const int dim = pool.ops().tangent_dim;
    for (int k = 0; k < pool.size(); ++k) {
      if (pool.fix(k) == Fix::kWhole || touched_[p][Index(k)] == 0) continue;
      if (pool.eliminated(k)) {
        variable_[p][Index(k)] = ~static_cast<std::int32_t>(landmarks_.size());
        landmarks_.push_back(
            {static_cast<std::int32_t>(p), k, dim, 0, num_landmark_scalars_, 0, 0});
        num_landmark_scalars_ += dim;
      } else {
        variable_[p][Index(k)] = static_cast<std::int32_t>(poses_.size());
        poses_.push_back({static_cast<std::int32_t>(p), k, pose_offsets_.back(), dim, 0, -1});
        step_offsets_[p][Index(k)] = pose_offsets_.back();
        pose_offsets_.push_back(pose_offsets_.back() + dim);
      }
    }
  }
  for (FlatEdges& edges : flat_) {
    edges.variable.resize(edges.index.size());
    edges.ForEachPool([&](std::size_t pool, std::size_t first, std::size_t step) {
      const std::int32_t* const variable = variable_[pool].data();
      const std::size_t size = edges.index.size();
      for (std::size_t k = first; k < size; k += step)
        edges.variable[k] = variable[edges.index[k]];
    });
  }
  const auto& tangents = graph.free_tangents();
  for (std::size_t t = 0; t < tangents.size(); ++t) {
    const VertexPoolBase* pool = graph.PoolOf(tangents[t].vertex.type);
    const int index = pool->slots().IndexOf(tangents[t].vertex.slot);
    const std::int32_t block = variable_[Index(pool->id())][Index(index)];
    if (block == kInactive) continue;
    poses_[Index(block)].free_tangent = static_cast<std::int32_t>(t);
    step_offsets_[Index(pool->id())][Index(index)] = -1;
  }
}

void Structure::NumberLandmarkSteps() {
  for (const LandmarkBlock& landmark : landmarks_) {
    step_offsets_[Index(landmark.pool)][Index(landmark.index)] = num_pose_scalars() + landmark.step;
  }
  for (const LandmarkGroup& group : plan_.groups) {
    std::vector<std::int32_t>& offsets = step_offsets_[Index(group.pool)];
    const std::int32_t first = num_pose_scalars() + plan_.first_step + group.step_begin;
    for (std::int32_t lane = 0; lane < group.used; ++lane)
      offsets[Index(plan_.landmark_of_lane[Index(group.lane_begin + lane)])] =
          first + group.dim * lane;
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

Status Structure::FindDuplicates(const Graph& graph) {
  for (std::size_t p = 0; p < num_pools_; ++p) {
    const EdgePoolBase& pool = *graph.edge_pools()[p];
    if (!pool.IsObservation() || pool.size() < 2) continue;
    const FlatEdges& edges = flat_[p];
    if (edges.arity == 0) continue;  // dynamic edges are not observations
    const int arity = edges.arity;
    std::size_t size = 64;
    while (size < 2 * Index(pool.size()))
      size *= 2;
    duplicate_table_.assign(size, {-1, -1});
    for (int edge = 0; edge < pool.size(); ++edge) {
      const std::int32_t* a = edges.index.data() + edges.Begin(edge);
      std::uint64_t hash = 0;
      for (int i = 0; i < arity; ++i) {
        hash = (hash ^ static_cast<std::uint32_t>(a[i])) * 0x9E3779B97F4A7C15ull;
        hash ^= hash >> 29;
      }
      std::size_t slot = static_cast<std::size_t>(hash >> 20) & (size - 1);
      for (; duplicate_table_[slot].edge >= 0; slot = (slot + 1) & (size - 1)) {
        const int other = duplicate_table_[slot].edge;
        const std::int32_t* b = edges.index.data() + edges.Begin(other);
        if (std::equal(a, a + arity, b) && pool.IsDuplicate(other, edge)) {
          const AnyEdge first = pool.HandleAt(other), second = pool.HandleAt(edge);
          return {
              StatusCode::kDuplicate,
              "the same observation twice: edges " + ToString(first) + " and " + ToString(second),
              first, second};
        }
      }
      duplicate_table_[slot] = {static_cast<std::int32_t>(p), edge};
    }
  }
  return {};
}

}  // namespace glissade
