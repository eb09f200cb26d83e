// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Dynamic edges that are evaluated many at once (edges/edge_batch.h).

#include <algorithm>
#include <cmath>

#include "glissade/edges/edge_batch.h"
#include "glissade/graph/dynamic_edge_pool.h"
#include "glissade/graph/pools.h"

namespace glissade {

/// The edges of each batch, in the order of the pool; batches in that of their first edge.
struct DynamicEdgePool::Batches {
  struct Of {
    const EdgeBatch* batch;
    std::vector<int> positions;
    std::vector<BatchedEdge> edges;
  };
  std::vector<Of> all;
};

bool DynamicEdgePool::HasBatches() const {
  return std::any_of(items_.begin(), items_.end(), [](const Entry& item) {
    return item.edge != nullptr && item.edge->batch() != nullptr;
  });
}

DynamicEdgePool::Batches DynamicEdgePool::FindBatches() const {
  Batches batches;
  Batches::Of* last = nullptr;  // neighbours are of the same one, as a rule
  for (int k = 0; k < size(); ++k) {
    if (!Alive(k)) continue;
    const Entry& item = EntryAt(k);
    const EdgeBatch* batch = item.edge->batch();
    if (batch == nullptr || item.edge->ConstantHessian() != nullptr) continue;
    if (last == nullptr || last->batch != batch) {
      const auto found = std::find_if(batches.all.begin(), batches.all.end(),
                                      [&](const auto& of) { return of.batch == batch; });
      last = found != batches.all.end() ? &*found
                                        : &batches.all.emplace_back(Batches::Of{batch, {}, {}});
    }
    last->positions.push_back(k);
    last->edges.emplace_back().edge = item.edge.get();
  }
  return batches;
}

void DynamicEdgePool::PointAtJacobians(const Entry& item) {
  const std::size_t rows = item.residual.size();
  item.jacobian.resize(rows * item.gradient.size());
  double* at = item.jacobian.data();
  for (std::size_t i = 0; i < item.refs.size(); ++i) {
    item.jacobian_of_vertex[i] = at;
    at += rows * static_cast<std::size_t>(item.refs[i].ops->tangent_dim);
  }
}

void DynamicEdgePool::EvaluateResiduals(Batches* batches) const {
  for (Batches::Of& of : batches->all) {
    for (std::size_t k = 0; k < of.edges.size(); ++k) {
      const Entry& item = EntryAt(of.positions[k]);
      FillRefs(item);
      of.edges[k].vertices = item.refs;
      of.edges[k].residual = item.residual.data();
    }
    of.batch->Evaluate(of.edges);
    for (std::size_t k = 0; k < of.edges.size(); ++k)
      EntryAt(of.positions[k]).batch_has_value = of.edges[k].has_value;
  }
}

void DynamicEdgePool::BeginCost() const {
  if (!HasBatches()) return;
  Batches batches = FindBatches();
  EvaluateResiduals(&batches);
}

void DynamicEdgePool::BeginLinearize(FirstEstimates first_estimates) const {
  if (!HasBatches()) return;
  Batches batches = FindBatches();
  // Residuals are those of the states, Jacobians are taken at the first estimates.
  const bool full = first_estimates == FirstEstimates::kFull;
  if (full) EvaluateResiduals(&batches);
  for (Batches::Of& of : batches.all) {
    for (std::size_t k = 0; k < of.edges.size(); ++k) {
      const Entry& item = EntryAt(of.positions[k]);
      FillRefs(item);
      PointAtJacobians(item);
      if (full) RefsToFirstEstimates(item);
      BatchedEdge& edge = of.edges[k];
      edge.vertices = item.refs;
      edge.residual = full ? item.points.data() : item.residual.data();
      edge.jacobians = item.jacobian_of_vertex.data();
      edge.has_value = false;
    }
    of.batch->Evaluate(of.edges);
    for (std::size_t k = 0; k < of.edges.size(); ++k) {
      bool& has_value = EntryAt(of.positions[k]).batch_has_value;
      has_value = of.edges[k].has_value && (!full || has_value);
    }
  }
}

std::vector<double> DynamicEdgePool::BatchedChi2() const {
  if (!HasBatches()) return {};
  // The entries' own scratch stays as it is: several threads may ask at once.
  std::vector<double> chi2(static_cast<std::size_t>(size()), NAN);
  for (Batches::Of& of : FindBatches().all) {
    std::size_t num_refs = 0, num_rows = 0;
    for (const int k : of.positions) {
      num_refs += EntryAt(k).vertices.size();
      num_rows += EntryAt(k).residual.size();
    }
    std::vector<VertexRef> refs(num_refs);
    std::vector<double> residuals(num_rows);
    VertexRef* ref = refs.data();
    double* row = residuals.data();
    for (std::size_t k = 0; k < of.edges.size(); ++k) {
      const Entry& item = EntryAt(of.positions[k]);
      of.edges[k].vertices = {ref, item.vertices.size()};
      of.edges[k].residual = row;
      row += item.residual.size();
      for (const Vertex& vertex : item.vertices) {
        const VertexPoolBase& pool = *vertex.pool;
        *ref++ = {&pool.ops(), pool.Data(pool.slots().IndexOf(vertex.slot))};
      }
    }
    of.batch->Evaluate(of.edges);
    for (std::size_t k = 0; k < of.edges.size(); ++k) {
      if (!of.edges[k].has_value) continue;
      double s = 0.0;
      for (std::size_t r = 0; r < EntryAt(of.positions[k]).residual.size(); ++r)
        s += of.edges[k].residual[r] * of.edges[k].residual[r];
      chi2[static_cast<std::size_t>(of.positions[k])] = s;
    }
  }
  return chi2;
}

}  // namespace glissade
