// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/normal_equations.h"
#include "glissade/base/index.h"
#include "glissade/graph/pools.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "linear/landmark_runs.h"
#include "linear/schur_storage.h"
#include "linear/twist_terms.h"

namespace glissade {

namespace {

using internal::Index;

StepFailure NoValue(const Graph& graph, int pool, int edge) {
  StepFailure failure;
  failure.code = StatusCode::kEvaluationFailed;
  failure.what = "has no finite residual or Jacobian";
  failure.edge = graph.edge_pools()[Index(pool)]->HandleAt(edge);
  return failure;
}

}  // namespace

StepFailure::operator Status() const {
  if (ok()) return {};
  if (edge) return {code, "edge " + ToString(edge) + " " + what, edge};
  if (!vertex) return {code, what};
  if (is_landmark) return {code, "landmark " + ToString(vertex) + " " + what, vertex};
  return {code, std::string(what) + " at vertex " + ToString(vertex), vertex};
}

NormalEquations::NormalEquations()
    : runs_(std::make_unique<LandmarkRuns>()),
      twists_(std::make_unique<TwistTerms>()),
      schur_(std::make_unique<SchurStorage>()) {}
NormalEquations::~NormalEquations() = default;
NormalEquations::NormalEquations(NormalEquations&&) noexcept = default;
NormalEquations& NormalEquations::operator=(NormalEquations&&) noexcept = default;

void NormalEquations::Resize(const Structure& structure) {
  num_poses_scalars_ = structure.num_pose_scalars();
  const std::size_t chunks = Index(structure.num_chunks());
  if (chunks_.size() < chunks) {
    chunks_.resize(chunks);
    h_pp_.resize(chunks);
    b_p_.resize(chunks);
  }
  for (std::size_t c = 0; c < chunks; ++c) {
    h_pp_[c].resize(Index(structure.varying_size()));
    b_p_[c].resize(Index(num_poses_scalars_));
  }
  constexpr std::size_t kSpare = 16;  // kernels may read so many numbers behind the last record
  landmarks_.resize(Index(structure.landmark_buffer_size()) + kSpare);
  const std::size_t size = Index(num_poses_scalars_ + structure.num_landmark_scalars());
  diagonal_.resize(size);
  b_.resize(size);
  step_.assign(size, 0.0);
  held_.assign(Index(num_poses_scalars_), 0);
}

void NormalEquations::LinearizeChunk(const Structure& structure, const Graph& graph, int chunk) {
  Chunk& out = chunks_[Index(chunk)];
  out.cost = 0.0;
  out.failed_edge = -1;
  std::fill(h_pp_[Index(chunk)].begin(), h_pp_[Index(chunk)].end(), 0.0);
  std::fill(b_p_[Index(chunk)].begin(), b_p_[Index(chunk)].end(), 0.0);
  runs_->ZeroRecords(structure, chunk, landmarks_.data());

  NormalEquationsSink sink;
  sink.h_pp = h_pp_[Index(chunk)].data();
  sink.b_p = b_p_[Index(chunk)].data();
  sink.landmarks = landmarks_.data();
  sink.records = structure.landmark_records().data();
  sink.first_estimates = graph.first_estimates();
  for (const EdgeRun& run : structure.EdgesOfChunk(chunk)) {
    if (run.count == 0) continue;
    const EdgePoolBase& pool = *graph.edge_pools()[Index(run.pool)];
    const std::int32_t taken = runs_->Taken(chunk, run.pool);
    if (taken == run.count) continue;  // there may be no records any more
    if (!pool.Linearize(structure.Words(run) + taken * plan::NumWords(pool.fixed_arity()),
                        run.count - taken, &sink)) {
      out.failed_pool = run.pool;
      out.failed_edge = sink.failed_edge;
      return;
    }
  }
  if (!runs_->Linearize(graph, chunk, &sink, &out.failed_pool)) {
    out.failed_edge = sink.failed_edge;
    return;
  }
  if (!twists_->Linearize(structure, graph, chunk, &sink, &out.failed_pool)) {
    out.failed_edge = sink.failed_edge;
    return;
  }
  FillLandmarks(structure, chunk);
  out.cost = sink.cost;
}

StepFailure NormalEquations::CheckCosts(const Structure& structure, const Graph& graph,
                                        double* cost) const {
  *cost = 0.0;
  for (int c = 0; c < structure.num_chunks(); ++c) {
    const Chunk& chunk = chunks_[Index(c)];
    if (chunk.failed_edge >= 0) return NoValue(graph, chunk.failed_pool, chunk.failed_edge);
    *cost += chunk.cost;
  }
  if (std::isfinite(*cost)) return {};
  StepFailure failure;
  failure.code = StatusCode::kNotFinite;
  failure.what = "the cost is not finite";
  return failure;
}

void NormalEquations::Plan(const Structure& structure, const Graph& graph) {
  runs_->Plan(structure, graph);
}

bool NormalEquations::IsPlanned(const Structure& structure) const {
  return runs_->IsPlanned(structure);
}

std::vector<bool> NormalEquations::PoolsInRuns(const Structure& structure) const {
  std::vector<bool> all(structure.EdgesOfChunk(0).size(), true);
  for (int chunk = 0; chunk < structure.num_chunks(); ++chunk) {
    for (const EdgeRun& edges : structure.EdgesOfChunk(chunk)) {
      if (runs_->Taken(chunk, edges.pool) != edges.count) all[Index(edges.pool)] = false;
    }
  }
  return all;
}

Status NormalEquations::Linearize(const Structure& structure, Graph* graph, ThreadPool* threads,
                                  double* cost) {
  linearized_ = 0;
  is_whole_ = false;
  Resize(structure);
  point_.Keep(*graph);
  for (FreeTangent& tangent : graph->free_tangents()) {
    const VertexPoolBase* pool = graph->PoolOf(tangent.vertex.type);
    tangent.UpdateBasis(pool->Data(pool->slots().IndexOf(tangent.vertex.slot)));
  }
  Plan(structure, *graph);
  twists_->Pack(structure, *graph);
  twists_->UpdatePoses(structure, *graph);
  twists_->UpdateFrames(structure, *graph);
  for (const auto& pool : graph->edge_pools())
    pool->BeginLinearize(graph->first_estimates());
  const int num_chunks = structure.num_chunks();
  threads->Run(num_chunks, [&](int chunk) { LinearizeChunk(structure, *graph, chunk); });
  if (const StepFailure failure = CheckCosts(structure, *graph, cost); !failure.ok()) {
    return failure;
  }
  if (num_chunks > 1) SumChunks(num_chunks, threads);
  ProjectFreeTangents(structure, graph);

  FindConstants(structure, *graph);
  FillDiagonal(structure);
  linearized_ = structure.analysis();
  return {};
}

void NormalEquations::SumChunks(int num_chunks, ThreadPool* threads) {
  // Each task takes a part of H_pp over all chunks.
  const std::size_t size = h_pp_[0].size();
  threads->Run(num_chunks, [&](int task) {
    const std::size_t end = size * Index(task + 1) / Index(num_chunks);
    for (int c = 1; c < num_chunks; ++c) {
      for (std::size_t k = size * Index(task) / Index(num_chunks); k < end; ++k)
        h_pp_[0][k] += h_pp_[Index(c)][k];
    }
  });
  for (int c = 1; c < num_chunks; ++c) {
    for (std::size_t k = 0; k < b_p_[0].size(); ++k)
      b_p_[0][k] += b_p_[Index(c)][k];
  }
}

StepFailure NormalEquations::Cost(const Structure& structure, const Graph& graph,
                                  ThreadPool* threads, double* cost) {
  twists_->UpdatePoses(structure, graph);
  for (const auto& pool : graph.edge_pools())
    pool->BeginCost();
  const int num_chunks = structure.num_chunks();
  threads->Run(num_chunks, [&](int c) {
    Chunk& chunk = chunks_[Index(c)];
    chunk.failed_edge = -1;
    NormalEquationsSink sink;
    for (const EdgeRun& run : structure.EdgesOfChunk(c)) {
      if (run.count == 0) continue;
      const EdgePoolBase& pool = *graph.edge_pools()[Index(run.pool)];
      const std::int32_t taken = runs_->Taken(c, run.pool);
      if (taken == run.count) continue;
      if (!pool.Cost(structure.Words(run) + taken * plan::NumWords(pool.fixed_arity()),
                     run.count - taken, &sink)) {
        chunk.failed_pool = run.pool;
        chunk.failed_edge = sink.failed_edge;
        return;
      }
    }
    if (!runs_->Cost(graph, c, &sink, &chunk.failed_pool)) {
      chunk.failed_edge = sink.failed_edge;
      return;
    }
    if (!twists_->Cost(structure, graph, c, &sink, &chunk.failed_pool)) {
      chunk.failed_edge = sink.failed_edge;
      return;
    }
    chunk.cost = sink.cost;
  });
  return CheckCosts(structure, graph, cost);
}

void NormalEquations::ListEvaluations(const Structure& structure, const Graph& graph,
                                      std::vector<EdgeEvaluation>* out) const {
  out->clear();
  if (!runs_->IsPlanned(structure)) return;
  // The graph may have got other pools since.
  const std::size_t num_pools =
      std::min(graph.edge_pools().size(), structure.EdgesOfChunk(0).size());
  for (std::size_t p = 0; p < num_pools; ++p) {
    const EdgePoolBase& pool = *graph.edge_pools()[p];
    const int id = static_cast<int>(p);
    EdgeEvaluation entry;
    entry.type = pool.type()->name;
    entry.lanes = runs_->Lanes(id) + twists_->Lanes(structure, id);
    entry.packs_redone = twists_->Redone(id);
    const auto as_twists = static_cast<int>(twists_->Edges(structure, id));
    entry.as_twists = as_twists;
    (pool.evaluates_in_packs() ? entry.in_packs : entry.one_by_one) += as_twists;
    for (int chunk = 0; chunk < structure.num_chunks(); ++chunk) {
      const int taken = runs_->Taken(chunk, id);
      (pool.evaluates_in_packs() ? entry.in_packs : entry.one_by_one) += taken;
      entry.one_by_one += structure.EdgesOfChunk(chunk)[p].count - taken;
      entry.packs_redone += runs_->Redone(chunk, id);
    }
    if (entry.in_packs + entry.one_by_one > 0) out->push_back(entry);
  }
}

void NormalEquations::ForgetRedonePacks() {
  runs_->ForgetRedone();
  twists_->ForgetRedone();
}

double NormalEquations::MaxGradient() const {
  double largest = 0.0, poison = 0.0;
  for (const double b : b_) {
    largest = std::max(largest, std::abs(b));
    poison += 0.0 * b;  // max() drops NaN
  }
  return largest + poison;
}

double NormalEquations::MaxDiagonal() const {
  double largest = 0.0;
  for (const double d : diagonal_)
    largest = std::max(largest, d);
  return largest;
}

double NormalEquations::StepNorm() const {
  double sum = 0.0;
  for (const double x : step_)
    sum += x * x;
  return std::sqrt(sum);
}

double NormalEquations::GradientDotStep() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < b_.size(); ++k)
    sum += b_[k] * step_[k];
  return sum;
}

double NormalEquations::StepDampingStep(const Structure& structure,
                                        const DampingTerm& damping) const {
  const std::size_t size =
      damping.reduced_only ? Index(structure.num_pose_scalars()) : step_.size();
  double sum = 0.0;
  for (std::size_t k = 0; k < size; ++k) {
    const double d = damping.identity || damping.reduced_only
                         ? 1.0
                         : std::clamp(diagonal_[k], damping.min_diagonal, damping.max_diagonal);
    sum += d * step_[k] * step_[k];
  }
  return sum;
}

double NormalEquations::ModelDecrease(const Structure& structure, const DampingTerm& damping,
                                      const LinearSolverResult& result) {
  // With (H + lambda D) dx = b + e, e the residual of the reduced solve:
  // b'dx - 1/2 dx'H dx = 1/2 (b'dx + lambda dx'D dx - dx'e).
  double decrease =
      0.5 * (GradientDotStep() + damping.lambda * StepDampingStep(structure, damping));
  if (!result.exact) {
    residual_.resize(Index(num_poses_scalars_));
    reduced().Multiply(step_.data(), residual_.data());
    for (std::size_t k = 0; k < residual_.size(); ++k) {
      decrease -= 0.5 * step_[k] * (residual_[k] - schur_->rhs()[k]);
    }
  }
  return decrease;
}

}  // namespace glissade
