// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What TwistTerms keeps of runs from one analysis to the next: weights, measurements, room.

#include <algorithm>

#include "linear/twist_terms.h"

namespace glissade {

namespace {

std::size_t Index(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

/// Values of so many edges stay in the first-level cache while they are used.
constexpr std::int32_t kMaxSegment = 64;
/// A camera is looked for among so many of its pose: a rig has a handful.
constexpr int kMaxLookedAt = 16;

}  // namespace

void TwistTerms::Pack(const Structure& structure, const Graph& graph) {
  if (analysis_ == structure.analysis() && weights_version_ == graph.weights_version()) return;
  analysis_ = structure.analysis();
  weights_version_ = graph.weights_version();
  const LandmarkPlan& plan = structure.groups();
  chunks_.resize(std::max(chunks_.size(), Index(structure.num_chunks())));
  maps_.assign(structure.poses().size(), {});
  projected_maps_.resize(structure.poses().size());
  segments_.clear();
  segment_begin_.assign(1, 0);
  weights_.Clear();
  uv_.clear();
  cameras_.clear();
  newest_camera_.clear();
  groups_.clear();
  targets_.clear();
  max_values_ = max_work_ = max_rows_ = 0;
  const std::size_t lanes = plan.landmark_of_lane.size();
  for (auto* array : {&b_, &h_, &scale_, &beta_, &inverse_h_})
    array->assign(lanes, 0.0);
  force_.assign(6 * Index(plan.pair_lanes), 0.0);
  has_run_.assign(plan.pairs.size(), 0);
  force_is_set_.assign(plan.pairs.size(), 0);
  std::size_t max_pairs = 0;
  for (const LandmarkPair& pair : plan.pairs)
    targets_.push_back({pair.lanes, force_.data() + 6 * std::int64_t{pair.begin}});
  for (const LandmarkGroup& group : plan.groups) {
    const std::int32_t pairs = group.pair_end - group.pair_begin;
    max_pairs = std::max(max_pairs, Index(pairs));
    groups_.push_back(
        {group.lanes, pairs, targets_.data() + group.pair_begin, b_.data() + group.lane_begin});
    for (std::int32_t r = group.run_begin; r < group.run_end; ++r)
      PackRun(plan, graph, group.host.pose, r);
    segment_begin_.push_back(static_cast<std::int32_t>(segments_.size()));
  }
  if (plan.empty()) return;
  for (Chunk& chunk : chunks_) {
    chunk.values.resize(std::max(chunk.values.size(), max_values_));
    chunk.work.resize(std::max(chunk.work.size(), max_work_));
    chunk.states.resize(kMaxSegment);
    chunk.points.assign(kMaxSegment, nullptr);
    chunk.weights.Resize(kMaxSegment, max_rows_);
    if (chunk.redone.size() < graph.edge_pools().size())
      chunk.redone.resize(graph.edge_pools().size(), 0);
    chunk.pairs.resize(std::max(chunk.pairs.size(), max_pairs));
  }
}

void TwistTerms::PackRun(const LandmarkPlan& plan, const Graph& graph, std::int32_t host,
                         std::int32_t index) {
  const LandmarkRun& run = plan.runs[Index(index)];
  const EdgePoolBase& pool = *graph.edge_pools()[Index(run.pool)];
  const int rows = pool.residual_dim(0);
  const bool sets_force = run.pair >= 0 && !has_run_[Index(run.pair)] && run.first == 0 &&
                          run.lanes == plan.pairs[Index(run.pair)].lanes;
  if (run.pair >= 0) has_run_[Index(run.pair)] = 1;
  if (sets_force) force_is_set_[Index(run.pair)] = 1;
  for (std::int32_t first = 0; first < run.lanes; first += kMaxSegment) {
    Segment segment;
    segment.run = index;
    segment.first = first;
    segment.lane = run.first + first;
    segment.sets_force = sets_force;
    segment.lanes = std::min(kMaxSegment, run.lanes - first);
    // Padding costs nothing in packs; and a run is then a whole number of them.
    segment.count = pool.evaluates_in_packs() ? segment.lanes
                                              : std::min(segment.lanes, run.used - segment.lane);
    const double* mask = plan.mask_of_slot.data() + run.begin + first;
    segment.masked = std::find(mask, mask + segment.count, 0.0) != mask + segment.count;
    segment.weights = weights_.Add(pool, plan.edge_of_slot.data() + run.begin + first, rows,
                                   segment.count, segment.lanes);
    PackTwoViews(plan, pool, host, &segment);
    segments_.push_back(segment);
  }
  max_rows_ = std::max(max_rows_, Index(rows));
  max_values_ = std::max(max_values_, Index(rows * kColumns) * Index(kMaxSegment));
  // One edge's residual and all of its Jacobians.
  max_work_ = std::max(max_work_, Index(rows * (kColumns + 6)));
}

void TwistTerms::PackTwoViews(const LandmarkPlan& plan, const EdgePoolBase& pool, std::int32_t host,
                              Segment* segment) {
  const LandmarkRun& run = plan.runs[Index(segment->run)];
  const std::int32_t* edges = plan.edge_of_slot.data() + run.begin + segment->first;
  TwoViewObservation observation;
  if (!pool.TwoView(edges[0], &observation)) return;
  segment->host_camera = FindCamera(host, observation.T_b_host);
  segment->target_camera =
      FindCamera(plan.pairs[Index(run.pair)].target.pose, observation.T_b_target);
  using Weights = LaneWeights::Run;
  segment->compact = (segment->weights.whitening == Weights::Whitening::kIdentity ||
                      segment->weights.whitening == Weights::Whitening::kScaled) &&
                     segment->weights.robust != Weights::Robust::kAny;
  segment->uv = static_cast<std::int64_t>(uv_.size());
  uv_.resize(uv_.size() + 4 * Index(segment->lanes));
  double* const uv = uv_.data() + segment->uv;
  for (std::int32_t s = 0; s < segment->lanes; ++s) {
    static_cast<void>(pool.TwoView(edges[s], &observation));
    for (int k = 0; k < 2; ++k) {
      uv[k * segment->lanes + s] = observation.uv_host[k];
      uv[(2 + k) * segment->lanes + s] = observation.uv_target[k];
    }
  }
}

// Cameras of one pose are chained, newest first. One that is not found among the newest is there
// twice, which costs its update and nothing else.
std::int32_t TwistTerms::FindCamera(std::int32_t pose, const double* T_b_c) {
  if (newest_camera_.size() <= Index(pose)) newest_camera_.resize(Index(pose) + 1, -1);
  std::int32_t& newest = newest_camera_[Index(pose)];
  int looked_at = 0;
  for (std::int32_t c = newest; c >= 0 && looked_at < kMaxLookedAt;
       c = cameras_[Index(c)].next, ++looked_at) {
    if (std::equal(T_b_c, T_b_c + 7, cameras_[Index(c)].T_b_c.data)) return c;
  }
  Camera camera;
  camera.pose = pose;
  camera.next = newest;
  std::copy_n(T_b_c, 7, camera.T_b_c.data);
  newest = static_cast<std::int32_t>(cameras_.size());
  cameras_.push_back(camera);
  return newest;
}

std::int64_t TwistTerms::Edges(const Structure& structure, int pool) const {
  const LandmarkPlan& plan = structure.groups();
  std::int64_t edges = 0;
  for (const LandmarkRun& run : plan.runs) {
    if (run.pool != pool) continue;
    const double* mask = plan.mask_of_slot.data() + run.begin;
    edges += std::count(mask, mask + run.lanes, 1.0);
  }
  return edges;
}

std::int64_t TwistTerms::Lanes(const Structure& structure, int pool) const {
  std::int64_t lanes = 0;
  for (const LandmarkRun& run : structure.groups().runs)
    lanes += run.pool == pool ? run.lanes : 0;
  return lanes;
}

std::int64_t TwistTerms::Redone(int pool) const {
  std::int64_t redone = 0;
  for (const Chunk& chunk : chunks_)
    redone += Index(pool) < chunk.redone.size() ? chunk.redone[Index(pool)] : 0;
  return redone;
}

void TwistTerms::ForgetRedone() {
  for (Chunk& chunk : chunks_)
    chunk.redone.assign(chunk.redone.size(), 0);
}

}  // namespace glissade
