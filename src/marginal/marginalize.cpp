// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/marginal/marginalize.h"

#include <cmath>
#include <string>
#include <utility>

#include "glissade/base/out_of_memory.h"
#include "glissade/base/validate.h"
#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/pools.h"
#include "glissade/linear/instruction_set.h"
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
  std::vector<AnyVertex> kept;
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

/// A prior edge may touch one eliminated vertex only: where it touches more they are kept. Undone
/// unless Commit() is called.
class KeptLandmarks {
 public:
  KeptLandmarks(Graph* graph, std::vector<AnyVertex>* kept) : graph_(graph), kept_(*kept) {
    kept_.clear();
  }
  KeptLandmarks(const KeptLandmarks&) = delete;
  KeptLandmarks& operator=(const KeptLandmarks&) = delete;
  ~KeptLandmarks() {
    for (const AnyVertex& vertex : kept_) {
      VertexPoolBase* pool = graph_->PoolOf(vertex.type);
      pool->set_eliminated(pool->slots().IndexOf(vertex.slot), true);
    }
  }
  Status Keep(const MarginalPrior& prior) {
    for (const AnyVertex& vertex : prior.vertices) {
      const VertexPoolBase* pool = graph_->PoolOf(vertex.type);
      if (pool->eliminated(pool->slots().IndexOf(vertex.slot))) kept_.push_back(vertex);
    }
    if (kept_.size() < 2) kept_.clear();
    for (const AnyVertex& vertex : kept_) {
      if (Status s = graph_->SetEliminated(vertex, false); !s.ok()) return s;
    }
    return {};
  }
  void Commit() { kept_.clear(); }

 private:
  Graph* graph_;
  std::vector<AnyVertex>& kept_;
};

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

namespace {

Status Validate(const MarginalizeOptions& options) {
  const auto refuse = [](const char* what) {
    return Status(StatusCode::kInvalidArgument, std::string("MarginalizeOptions: ") + what);
  };
  if (options.form != MarginalForm::kSquareRootQr && options.form != MarginalForm::kSchur) {
    return refuse("form is no MarginalForm");
  }
  if (options.root != InformationRoot::kCholesky && options.root != InformationRoot::kEigen) {
    return refuse("root is no InformationRoot");
  }
  return internal::ValidateRelativeCut(options.relative_cut, "MarginalizeOptions");
}

Status Compute(const Graph& graph, std::span<const AnyVertex> vertices,
               const MarginalizeOptions& options, MarginalWorkspace* workspace,
               MarginalPrior* prior) {
  Reset(prior);
  if (Status s = CheckInstructionSet(); !s.ok()) return s;
  if (Status s = Validate(options); !s.ok()) return s;
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
  if (status.ok() && !(finite(prior->r0) && finite(prior->jacobian) &&
                       std::isfinite(prior->report.constant_cost))) {
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

}  // namespace

Status ComputeMarginalPrior(const Graph& graph, std::span<const AnyVertex> vertices,
                            const MarginalizeOptions& options, MarginalWorkspace* workspace,
                            MarginalPrior* prior) {
  const Status status =
      internal::OrOutOfMemory([&] { return Compute(graph, vertices, options, workspace, prior); });
  if (!status.ok()) Reset(prior);
  return status;
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

namespace {

Result<Marginalization> TakeOut(Graph* graph, std::span<const AnyVertex> vertices,
                                const MarginalizeOptions& options, MarginalWorkspace* workspace) {
  MarginalWorkspace::Impl& w = workspace->impl();
  if (Status s = ComputeMarginalPrior(*graph, vertices, options, workspace, &w.prior); !s.ok()) {
    return s;
  }
  // All that can fail or run out of memory comes before the first change that is not undone.
  Marginalization result;
  result.rows = w.prior.rows();
  result.tangent_dim = w.prior.tangent_dim;
  result.report = w.prior.report;
  std::unique_ptr<DynamicEdge> edge;
  if (result.rows > 0 && result.tangent_dim > 0) {
    if (Status s = MakeEdge(*graph, w.prior, &w, &edge); !s.ok()) {
      return s;
    }
    KeptLandmarks landmarks(graph, &w.kept);
    if (Status s = landmarks.Keep(w.prior); !s.ok()) return s;
    auto added = graph->AddEdge(std::move(edge), w.prior.vertices);
    if (!added.ok()) return added.status();
    result.prior = added.value();
    landmarks.Commit();
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

}  // namespace

Result<Marginalization> Marginalize(Graph* graph, std::span<const AnyVertex> vertices,
                                    const MarginalizeOptions& options,
                                    MarginalWorkspace* workspace) {
  MarginalWorkspace own;
  if (workspace == nullptr) workspace = &own;
  auto result =
      internal::OrOutOfMemory([&] { return TakeOut(graph, vertices, options, workspace); });
  if (!result.ok()) static_cast<void>(graph->Refused(result.status()));
  return result;
}

}  // namespace glissade
