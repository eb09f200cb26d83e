// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/landmark_runs.h"

#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "kernels/kernels.h"

namespace glissade {

namespace {

using internal::Index;

}  // namespace

int LandmarkRuns::Evaluate(const Graph& graph, const Run& run, const Values& values,
                           FirstEstimates first_estimates, Scratch* scratch) const {
  const EdgePoolBase& pool = *graph.edge_pools()[Index(run.pool)];
  const Vertex* vertex = vertex_.data() + run.vertex_begin;
  const double *states[kMaxTypedArity], *points[kMaxTypedArity];
  const bool keeps = first_estimates == FirstEstimates::kFull;
  for (int i = 0; i < run.arity; ++i) {
    const VertexPoolBase& vertices = *pool.vertex_pool(0, i);
    if (i != run.landmark) {
      states[i] = vertices.Data(vertex[i].index);
      points[i] = keeps ? vertices.first_estimates().At(vertex[i].index) : nullptr;
      continue;
    }
    states[i] = points[i] = nullptr;
    for (int s = 0; s < run.count; ++s) {
      const std::int32_t index = landmark_[Index(run.lane_begin + s)];
      scratch->states[Index(s)] = vertices.Data(index);
      scratch->points[Index(s)] = keeps ? vertices.first_estimates().At(index) : nullptr;
    }
  }
  LaneRun lanes;
  lanes.count = run.count;
  lanes.lanes = run.lanes;
  lanes.edges = edge_.data() + run.lane_begin;
  lanes.landmark = run.landmark;
  lanes.states = states;
  lanes.points = points;
  lanes.landmark_states = scratch->states.data();
  lanes.landmark_points = scratch->points.data();
  lanes.work = scratch->work.data();
  const bool linearizes = values.J[run.landmark] != nullptr;
  const int failed = pool.EvaluateRun(
      lanes, {values.r, linearizes ? values.J : nullptr, scratch->redone + run.pool},
      first_estimates);
  if (failed >= 0 || run.count == run.lanes) return failed;
  for (std::int64_t k = 0; k < values.count; k += run.lanes)
    std::fill(values.r + k + run.count, values.r + k + run.lanes, 0.0);
  return -1;
}

LandmarkRuns::Values LandmarkRuns::Place(const Run& run, bool jacobians, Scratch* scratch) const {
  Values values;
  double* next = scratch->values.data();
  const std::int64_t row_of_lanes = std::int64_t{run.rows} * run.lanes;
  values.r = next;
  next += row_of_lanes;
  for (int i = 0; jacobians && i < run.arity; ++i) {
    const Vertex& vertex = vertex_[Index(run.vertex_begin + i)];
    if (vertex.target == plan::kNone) continue;
    values.J[i] = next;
    next += row_of_lanes * vertex.dim;
  }
  values.count = next - values.r;
  return values;
}

int LandmarkRuns::Weigh(const Graph& graph, const Run& run, const Values& values, Scratch* scratch,
                        double* cost) const {
  const kernels::KernelTable& kernel = kernels::Kernels();
  LaneMatrix J[kMaxTypedArity];
  std::size_t matrices = 0;
  for (int i = 0; i < run.arity; ++i) {
    if (values.J[i] == nullptr) continue;
    J[matrices++] = {values.J[i], vertex_[Index(run.vertex_begin + i)].dim};
  }
  LaneWeights::Factors factors;
  const int failed = weights_.Weigh(run.weights, *graph.edge_pools()[Index(run.pool)],
                                    edge_.data() + run.lane_begin, nullptr, values.r, {J, matrices},
                                    &scratch->weights, cost, &factors);
  if (failed >= 0 || matrices == 0) return failed;
  if (factors.weight != nullptr) kernel.scale_lanes(run.rows, run.lanes, factors.weight, values.r);
  if (factors.weight == nullptr && factors.scale == 1.0) return -1;
  double* const factor = scratch->factor.data();
  for (int s = 0; s < run.lanes; ++s)
    factor[s] = factors.weight != nullptr ? factors.scale * factors.weight[s] : factors.scale;
  for (std::size_t m = 0; m < matrices; ++m)
    kernel.scale_lanes(run.rows * J[m].cols, run.lanes, factor, J[m].data);
  return -1;
}

void LandmarkRuns::Accumulate(const Run& run, const Values& values,
                              NormalEquationsSink* sink) const {
  const kernels::KernelTable& kernel = kernels::Kernels();
  const Vertex* vertex = vertex_.data() + run.vertex_begin;
  const double* J_l = values.J[run.landmark];
  const int dl = vertex[run.landmark].dim;
  const std::int64_t* record = record_.data() + run.lane_begin;
  kernel.lane_landmarks(run.rows, run.lanes, run.count, dl, J_l, values.r, record, sink->landmarks);
  for (int i = 0; i < run.arity; ++i) {
    if (i == run.landmark || values.J[i] == nullptr) continue;
    const int dim = vertex[i].dim;
    const double* J_i = values.J[i];
    kernel.lane_products(run.rows, run.lanes, dim, J_i, 1, values.r, -1.0,
                         sink->b_p + vertex[i].target);
    kernel.lane_couplings(run.rows, run.lanes, run.count, dim, J_i, dl, J_l,
                          w_.data() + run.WBegin(i), (run.sets >> i & 1u) != 0, sink->landmarks);
    for (int j = 0; j <= i; ++j) {
      const std::int64_t offset = h_block_[Index(run.pair_begin + plan::Pair(i, j))];
      if (offset == plan::kNone) continue;
      const double* J_j = values.J[j];
      if (offset >= 0) {
        kernel.lane_products(run.rows, run.lanes, dim, J_i, vertex[j].dim, J_j, 1.0,
                             sink->h_pp + offset);
      } else {
        kernel.lane_products(run.rows, run.lanes, vertex[j].dim, J_j, dim, J_i, 1.0,
                             sink->h_pp - offset - 2);
      }
    }
  }
}

void LandmarkRuns::ZeroRecords(const Structure& structure, int chunk, double* landmarks) const {
  const std::int32_t begin = structure.landmark_chunks()[Index(chunk)];
  const std::int32_t end = structure.landmark_chunks()[Index(chunk) + 1];
  if (adds_to_all_[Index(chunk)] != 0) {
    const auto record = [&](std::int32_t l) {
      return Index(l) < structure.landmarks().size() ? structure.landmarks()[Index(l)].record
                                                     : structure.landmark_buffer_size();
    };
    std::fill(landmarks + record(begin), landmarks + record(end), 0.0);
    return;
  }
  for (std::int32_t l = begin; l < end; ++l) {
    const LandmarkBlock& landmark = structure.landmarks()[Index(l)];
    std::fill_n(landmarks + landmark.record, landmark.dim * landmark.dim + landmark.dim, 0.0);
  }
  for (std::int32_t k = added_begin_[Index(chunk)]; k < added_begin_[Index(chunk) + 1]; ++k)
    std::fill_n(landmarks + added_[Index(k)].offset, added_[Index(k)].size, 0.0);
}

bool LandmarkRuns::Linearize(const Graph& graph, int chunk, NormalEquationsSink* sink,
                             std::int32_t* pool) {
  Scratch* scratch = &scratch_[Index(chunk)];
  scratch->redone = redone_.data() + Index(chunk) * num_pools_;
  for (int k = chunk_begin_[Index(chunk)]; k < chunk_begin_[Index(chunk) + 1]; ++k) {
    const Run& run = runs_[Index(k)];
    const Values values = Place(run, true, scratch);
    int failed = Evaluate(graph, run, values, sink->first_estimates, scratch);
    if (failed < 0) failed = Weigh(graph, run, values, scratch, &sink->cost);
    if (failed < 0 && kernels::Kernels().lanes_finite(values.count, values.r) == 0) {
      failed = FindNotFiniteLane(run.lanes, values.count, values.r);
    }
    if (failed >= 0) return Fail(run, failed, sink, pool);
    Accumulate(run, values, sink);
  }
  return true;
}

bool LandmarkRuns::Cost(const Graph& graph, int chunk, NormalEquationsSink* sink,
                        std::int32_t* pool) {
  Scratch* scratch = &scratch_[Index(chunk)];
  scratch->redone = redone_.data() + Index(chunk) * num_pools_;
  for (int k = chunk_begin_[Index(chunk)]; k < chunk_begin_[Index(chunk) + 1]; ++k) {
    const Run& run = runs_[Index(k)];
    const Values values = Place(run, false, scratch);
    int failed = Evaluate(graph, run, values, sink->first_estimates, scratch);
    if (failed < 0) failed = Weigh(graph, run, values, scratch, &sink->cost);
    if (failed >= 0) return Fail(run, failed, sink, pool);
  }
  return true;
}

bool LandmarkRuns::Fail(const Run& run, int lane, NormalEquationsSink* sink,
                        std::int32_t* pool) const {
  *pool = run.pool;
  sink->failed_edge = edge_[Index(run.lane_begin + lane)];
  return false;
}

}  // namespace glissade
