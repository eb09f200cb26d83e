// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/marginal/marginalize.h"

#include <utility>

#include "glissade/base/validate.h"
#include "glissade/edges/marginal_prior.h"
#include "marginal/schur_form.h"
#include "marginal/square_root_form.h"
#include "marginal/system.h"

namespace glissade {

class MarginalWorkspace::Impl {
 public:
  internal::MarginalSystem system;
  internal::SquareRootForm square_root;
  internal::SchurForm schur;
  MarginalPrior prior;
  std::vector<const VertexOps*> types;
  std::unique_ptr<EdgeMarginalPrior> spare;  // an older prior, for its storage
};

MarginalWorkspace::MarginalWorkspace() = default;
MarginalWorkspace::~MarginalWorkspace() = default;
MarginalWorkspace::MarginalWorkspace(MarginalWorkspace&&) noexcept = default;
MarginalWorkspace& MarginalWorkspace::operator=(MarginalWorkspace&&) noexcept = default;

MarginalWorkspace::Impl& MarginalWorkspace::impl() {
  if (impl_ == nullptr) impl_ = std::make_unique<Impl>();
  return *impl_;
}

namespace {

void Reset(MarginalPrior* prior) {
  prior->vertices.clear();
  prior->x0.clear();
  prior->r0.clear();
  prior->jacobian.clear();
  prior->tangent_dim = 0;
  std::vector<AnyVertex> deficient = std::move(prior->report.deficient);
  deficient.clear();
  prior->report = {};
  prior->report.deficient = std::move(deficient);
}

/// An edge with the numbers of the prior, in the storage of an older one where there is one.
Status MakeEdge(const Graph& graph, const MarginalPrior& prior, MarginalWorkspace::Impl* w,
                std::unique_ptr<DynamicEdge>* edge) {
  w->types.clear();
  for (const AnyVertex& vertex : prior.vertices)
    w->types.push_back(&graph.PoolOf(vertex.type)->ops());
  if (w->spare != nullptr) {
    std::unique_ptr<EdgeMarginalPrior> reused = std::move(w->spare);
    if (Status s = reused->Assign(w->types, prior.x0, prior.r0, prior.jacobian); !s.ok()) return s;
    *edge = std::move(reused);
    return {};
  }
  auto made = EdgeMarginalPrior::Create(w->types, prior.x0, prior.r0, prior.jacobian);
  if (!made.ok()) return made.status();
  *edge = std::move(made).value();
  return {};
}

/// A prior edge may touch one eliminated vertex only: where it touches more they are kept.
Status KeepLandmarksOf(const MarginalPrior& prior, Graph* graph) {
  const auto eliminated = [&](AnyVertex vertex) {
    const VertexPoolBase* pool = graph->PoolOf(vertex.type);
    return pool->eliminated(pool->slots().IndexOf(vertex.slot));
  };
  int count = 0;
  for (const AnyVertex& vertex : prior.vertices)
    count += eliminated(vertex) ? 1 : 0;
  for (const AnyVertex& vertex : prior.vertices) {
    if (count < 2) break;
    if (!eliminated(vertex)) continue;
    if (Status s = graph->SetEliminated(vertex, false); !s.ok()) return s;
  }
  return {};
}

/// One of the priors that have gone, for its storage.
std::unique_ptr<EdgeMarginalPrior> TakeGonePrior(Graph* graph) {
  auto* pool = static_cast<DynamicEdgePool*>(graph->EdgePoolOf(&kTypeInfo<DynamicEdge>));
  for (int edge = 0; pool != nullptr && edge < pool->size(); ++edge) {
    if (pool->Alive(edge)) continue;
    std::unique_ptr<DynamicEdge> gone = pool->TakeRemoved(edge);
    if (auto* prior = dynamic_cast<EdgeMarginalPrior*>(gone.get())) {
      static_cast<void>(gone.release());
      return std::unique_ptr<EdgeMarginalPrior>(prior);
    }
  }
  return nullptr;
}

}  // namespace

Status ComputeMarginalPrior(const Graph& graph, std::span<const AnyVertex> vertices,
                            const MarginalizeOptions& options, MarginalWorkspace* workspace,
                            MarginalPrior* prior) {
  Reset(prior);
  MarginalWorkspace own;
  MarginalWorkspace::Impl& w = (workspace != nullptr ? *workspace : own).impl();
  internal::MarginalSystem& system = w.system;
  Status status = system.Build(graph, vertices, options, &prior->report);
  if (status.ok()) {
    status =
        options.form == MarginalForm::kSchur
            ? w.schur.Run(&system, options, &prior->report, &prior->r0, &prior->jacobian)
            : w.square_root.Run(&system, options, &prior->report, &prior->r0, &prior->jacobian);
  }
  const auto finite = [](const std::vector<double>& x) {
    return internal::AllFinite(x.data(), static_cast<int>(x.size()));
  };
  if (status.ok() && !(finite(prior->r0) && finite(prior->jacobian))) {
    status = {StatusCode::kNotFinite, "Marginalize: the prior is not finite"};
  }
  if (!status.ok()) {
    Reset(prior);
    return status;
  }
  for (const std::int32_t k : system.dense_order()) {
    const internal::MarginalVariable& v = system.variable(k);
    if (v.kind != internal::MarginalVariable::Kind::kStays) continue;
    prior->vertices.push_back(v.pool->HandleAt(v.index));
    prior->x0.insert(prior->x0.end(), v.x0, v.x0 + v.pool->ops().ambient_dim);
  }
  prior->tangent_dim = system.staying_dim();
  return {};
}

Result<MarginalPrior> ComputeMarginalPrior(const Graph& graph, std::span<const AnyVertex> vertices,
                                           const MarginalizeOptions& options,
                                           MarginalWorkspace* workspace) {
  MarginalPrior prior;
  if (Status s = ComputeMarginalPrior(graph, vertices, options, workspace, &prior); !s.ok()) {
    return s;
  }
  return prior;
}

Result<Marginalization> Marginalize(Graph* graph, std::span<const AnyVertex> vertices,
                                    const MarginalizeOptions& options,
                                    MarginalWorkspace* workspace) {
  MarginalWorkspace own;
  if (workspace == nullptr) workspace = &own;
  MarginalWorkspace::Impl& w = workspace->impl();
  if (Status s = ComputeMarginalPrior(*graph, vertices, options, workspace, &w.prior); !s.ok()) {
    return graph->Refused(std::move(s));
  }
  // All that can fail comes before the first change.
  Marginalization result;
  result.rows = w.prior.rows();
  result.tangent_dim = w.prior.tangent_dim;
  result.report = w.prior.report;
  std::unique_ptr<DynamicEdge> edge;
  if (result.rows > 0 && result.tangent_dim > 0) {
    if (Status s = MakeEdge(*graph, w.prior, &w, &edge); !s.ok()) {
      return graph->Refused(std::move(s));
    }
    if (Status s = KeepLandmarksOf(w.prior, graph); !s.ok()) return s;
    auto added = graph->AddEdge(std::move(edge), w.prior.vertices);
    if (!added.ok()) return added.status();
    result.prior = added.value();
  }
  for (const AnyVertex& vertex : vertices) {
    // Older priors on it are part of the new one.
    if (Status s = graph->RemoveVertex(vertex, PriorOnVertex::kRemove); !s.ok()) return s;
  }
  if (graph->first_estimates() == FirstEstimates::kOff && result.prior.slot != kNullSlot) {
    const double* x0 = w.prior.x0.data();
    for (const AnyVertex& vertex : w.prior.vertices) {
      const auto dim = static_cast<std::size_t>(graph->PoolOf(vertex.type)->ops().ambient_dim);
      if (Status s = graph->SetFirstEstimate(vertex, {x0, dim}); !s.ok()) return s;
      x0 += dim;
    }
  }
  if (w.spare == nullptr) w.spare = TakeGonePrior(graph);
  return result;
}

}  // namespace glissade
