// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/pools.h"

#include <atomic>
#include <utility>

namespace glissade {

namespace internal {

Status About(const Status& status, std::string_view subject) {
  if (status.ok()) return status;
  std::string message = std::string(subject) + ": " + status.message();
  if (status.other_edge()) {
    return {status.code(), std::move(message), status.edge(), status.other_edge()};
  }
  return {status.code(), std::move(message), status.vertex(), status.edge()};
}

}  // namespace internal

namespace {

/// By the oldest element; stable, in place (there are a handful of pools).
template <class Pool>
void SortByAge(std::vector<std::unique_ptr<Pool>>* pools) {
  for (std::size_t k = 1; k < pools->size(); ++k) {
    for (std::size_t i = k; i > 0; --i) {
      auto &before = (*pools)[i - 1], &after = (*pools)[i];
      if (before->slots().FirstStamp() <= after->slots().FirstStamp()) break;
      std::swap(before, after);
    }
  }
}

}  // namespace

Graph::Graph() : identity_(NewIdentity()) {}
Graph::~Graph() = default;

// Only ever compared for equality, so that nothing depends on how many graphs there were before.
std::uint64_t Graph::NewIdentity() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

// One for every graph that something is added to: as for versions, none depends on its value.
std::uint32_t Graph::NewId() {
  static std::atomic<std::uint32_t> last{0};
  std::uint32_t id = ++last;
  while (id == 0)
    id = ++last;
  return id;
}

Graph::Graph(Graph&& other) noexcept : Graph() {
  *this = std::move(other);
}

Graph& Graph::operator=(Graph&& other) noexcept {
  if (this == &other) return *this;
  other.EndHold();  // whoever began it does not come along
  vertex_pools_ = std::exchange(other.vertex_pools_, {});
  edge_pools_ = std::exchange(other.edge_pools_, {});
  free_tangents_ = std::exchange(other.free_tangents_, {});
  saved_free_tangents_ = std::exchange(other.saved_free_tangents_, {});
  hold_ = std::exchange(other.hold_, {});
  gauge_references_ = std::exchange(other.gauge_references_, {});
  first_estimates_ = other.first_estimates_;
  structure_version_ = other.structure_version_;
  weights_version_ = other.weights_version_;
  identity_ = std::exchange(other.identity_, NewIdentity());
  id_ = std::exchange(other.id_, 0);
  first_refusal_ = std::exchange(other.first_refusal_, {});
  return *this;
}

VertexPoolBase* Graph::PoolOf(const TypeInfo* type) const {
  for (const auto& pool : vertex_pools_) {
    if (pool->ops().type == type) return pool.get();
  }
  return nullptr;
}

EdgePoolBase* Graph::EdgePoolOf(const TypeInfo* type) const {
  for (const auto& pool : edge_pools_) {
    if (pool->type() == type) return pool.get();
  }
  return nullptr;
}

EdgePool* Graph::TypedEdgePoolOf(const TypeInfo* type) const {
  return static_cast<EdgePool*>(EdgePoolOf(type));
}

Graph::VertexSite Graph::Locate(AnyVertex vertex) const {
  VertexPoolBase* pool = vertex.type == nullptr ? nullptr : PoolOf(vertex.type);
  if (pool == nullptr || !pool->slots().Contains(vertex)) return {};
  return {pool, pool->slots().IndexOf(vertex.slot)};
}

Graph::EdgeSite Graph::Locate(AnyEdge edge) const {
  EdgePoolBase* pool = edge.type == nullptr ? nullptr : EdgePoolOf(edge.type);
  if (pool == nullptr || !pool->slots().Contains(edge)) return {};
  const int index = pool->slots().IndexOf(edge.slot);
  if (!pool->Alive(index)) return {};
  return {pool, index};
}

bool Graph::Contains(AnyVertex vertex) const {
  return Locate(vertex).pool != nullptr;
}
bool Graph::Contains(AnyEdge edge) const {
  return Locate(edge).pool != nullptr;
}

Status Graph::RemoveVertex(AnyVertex vertex, PriorOnVertex prior) {
  return Refused(RemoveVertexChecked(vertex, prior));
}

Status Graph::RemoveVertexChecked(AnyVertex vertex, PriorOnVertex on_prior) {
  const VertexSite site = Locate(vertex);
  if (site.pool == nullptr) return UnknownHandle(vertex);
  // Every vertex under a prior has a first estimate: the others need no search.
  const bool has_estimate = site.pool->first_estimates().At(site.index) != nullptr;
  const AnyEdge prior = has_estimate ? PriorOn(*site.pool, site.index) : AnyEdge();
  if (prior && on_prior == PriorOnVertex::kRefuse) {
    return {StatusCode::kUnderPrior,
            "RemoveVertex: " + ToString(vertex) + " is under the marginal prior " +
                ToString(prior) + ", which would go too: Marginalize() keeps what it says of " +
                "others, PriorOnVertex::kRemove gives it up",
            vertex, prior};
  }
  DropFreeTangent(vertex);
  DropGaugeReference(vertex);
  for (const auto& pool : edge_pools_)
    pool->RemoveEdgesAt(*site.pool, vertex.slot);
  site.pool->Remove(vertex.slot);
  if (prior) DropOrphanedFirstEstimates();
  StructureChanged();
  return {};
}

Status Graph::RemoveEdge(AnyEdge edge) {
  const EdgeSite site = Locate(edge);
  if (site.pool == nullptr) return Refused(UnknownHandle(edge));
  const bool is_prior =
      edge.type == &kTypeInfo<DynamicEdge> &&
      static_cast<DynamicEdgePool*>(site.pool)->At(site.index).LinearizationPoint() != nullptr;
  site.pool->Remove(edge.slot);
  if (is_prior) DropOrphanedFirstEstimates();
  StructureChanged();
  return {};
}

Status Graph::CheckLoss(AnyEdge edge, const Loss& loss) const {
  const EdgeSite site = Locate(edge);
  if (site.pool == nullptr) return UnknownHandle(edge);
  if (Status status = loss.Validate(); !status.ok()) {
    return {status.code(), status.message(), edge};
  }
  if (!loss.trivial() && edge.type == &kTypeInfo<DynamicEdge> &&
      static_cast<DynamicEdgePool*>(site.pool)->At(site.index).ConstantHessian() != nullptr) {
    return {StatusCode::kInvalidArgument,
            "a dynamic edge with a constant Hessian cannot have a robust loss", edge};
  }
  return {};
}

Status Graph::SetLoss(AnyEdge edge, const Loss& loss) {
  if (Status status = CheckLoss(edge, loss); !status.ok()) return Refused(std::move(status));
  const EdgeSite site = Locate(edge);
  // What was linearized with another kind of loss is refused, as after a change of structure.
  if (site.pool->loss(site.index).type() != loss.type()) StructureChanged();
  site.pool->set_loss(site.index, loss);
  ++weights_version_;
  return {};
}

void Graph::Compact() {
  for (const auto& pool : edge_pools_)
    pool->Compact();
  for (const auto& pool : vertex_pools_)
    pool->Compact();
  SortByAge(&edge_pools_);
  SortByAge(&vertex_pools_);
  for (std::size_t k = 0; k < vertex_pools_.size(); ++k)
    vertex_pools_[k]->set_id(static_cast<int>(k));
}

void Graph::SaveStates() {
  for (const auto& pool : vertex_pools_)
    pool->Save();
  saved_free_tangents_ = free_tangents_;
}

void Graph::RestoreStates() {
  for (const auto& pool : vertex_pools_)
    pool->Restore();
  free_tangents_ = saved_free_tangents_;
}

Result<Graph> Graph::Clone() const {
  Graph copy;
  for (const auto& pool : vertex_pools_)
    copy.vertex_pools_.push_back(std::make_unique<VertexPoolBase>(*pool));
  for (const auto& pool : edge_pools_) {
    AnyEdge failed;
    copy.edge_pools_.push_back(pool->Clone(copy.vertex_pools_, &failed));
    if (copy.edge_pools_.back() != nullptr) continue;
    return Status(StatusCode::kInvalidArgument,
                  "Clone: the Clone() of edge " + ToString(failed) + " returned null", failed);
  }
  copy.free_tangents_ = free_tangents_;
  copy.first_estimates_ = first_estimates_;
  copy.gauge_references_ = gauge_references_;
  copy.structure_version_ = structure_version_;
  copy.first_refusal_ = first_refusal_;
  return copy;
}

}  // namespace glissade
