// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/dynamic_edge_pool.h"
#include "glissade/graph/pools.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace glissade {

namespace {

/// What a dynamic edge says of scale is not asked: as a rule it is a prior.
constexpr EdgeTraits kDynamicTraits{.scale_rule = ScaleRule::kPrior};

}  // namespace

DynamicEdgePool::DynamicEdgePool() : EdgePoolBase(&kTypeInfo<DynamicEdge>, kDynamicTraits, 0) {}

EdgeHandle<DynamicEdge> DynamicEdgePool::Add(std::unique_ptr<DynamicEdge> edge,
                                             std::span<const Vertex> vertices, const Loss& loss,
                                             std::uint64_t stamp, std::uint32_t graph) {
  // All that can run out of memory comes before the first change.
  Entry item;
  if (!spare_.empty()) {
    item = std::move(spare_.back());
    spare_.pop_back();
  }
  item.edge = std::move(edge);
  item.vertices.assign(vertices.begin(), vertices.end());
  PrepareItem(&item);
  const std::uint32_t loss_index = FindOrAddLoss(loss);
  internal::MakeRoomIn(&items_);
  internal::MakeRoomIn(&loss_of_edge_);
  internal::MakeRoomIn(&spare_);  // for TakeBack()
  for (const Vertex& vertex : vertices)
    lists_.MakeRoom(lists_.ColumnOf(vertex.pool), vertex.slot);
  lists_.MakeRoomForLinks(vertices.size());
  slots_.MakeRoom();
  const auto address = slots_.Add(stamp, graph);
  items_.push_back(std::move(item));
  loss_of_edge_.push_back(loss_index);
  Link(size() - 1);
  return {address.slot, address.generation, graph};
}

bool DynamicEdgePool::TakeBack(EdgeHandle<DynamicEdge> edge) {
  if (!slots_.Contains(edge) || !slots_.IsLast(edge.slot)) return false;
  slots_.PopLast();
  const std::vector<Vertex>& vertices = items_.back().vertices;
  for (std::size_t i = vertices.size(); i-- > 0;)
    lists_.TakeBack(lists_.ColumnOf(vertices[i].pool), vertices[i].slot);
  items_.back().edge.reset();
  spare_.push_back(std::move(items_.back()));
  items_.pop_back();
  loss_of_edge_.pop_back();
  return true;
}

void DynamicEdgePool::Link(int edge) {
  for (const Vertex& vertex : EntryAt(edge).vertices)
    lists_.Append(lists_.ColumnOf(vertex.pool), vertex.slot, edge);
}

void DynamicEdgePool::PrepareItem(Entry* item) const {
  const auto rows = static_cast<std::size_t>(item->edge->ResidualDim());
  std::size_t dim = 0;
  for (const Vertex& vertex : item->vertices) {
    dim += static_cast<std::size_t>(vertex.pool->ops().tangent_dim);
  }
  item->refs.resize(item->vertices.size());
  item->gradient.resize(dim);
  item->residual.reserve(std::max(rows, dim));  // a prior's rank varies
  item->residual.resize(rows);
  item->jacobian_of_vertex.resize(item->vertices.size());
  if (item->edge->ConstantHessian() == nullptr) item->jacobian.resize(rows * dim);
  FillRefs(*item);
}

void DynamicEdgePool::Prepare() {
  for (Entry& item : items_)
    PrepareItem(&item);
}

void DynamicEdgePool::FillRefs(const Entry& item) const {
  for (std::size_t i = 0; i < item.vertices.size(); ++i) {
    VertexPoolBase* pool = item.vertices[i].pool;
    item.refs[i] = {&pool->ops(), pool->Data(pool->slots().IndexOf(item.vertices[i].slot))};
  }
}

void DynamicEdgePool::SetRefs(const Entry& item, const std::int32_t* words) const {
  for (std::size_t i = 0; i < item.vertices.size(); ++i) {
    item.refs[i].data = item.vertices[i].pool->Data(words[plan::State(static_cast<int>(i))]);
  }
}

void DynamicEdgePool::AllDenseIndices(std::int32_t* indices) const {
  for (const Entry& item : items_) {
    for (const Vertex& vertex : item.vertices) {
      *indices++ = vertex.pool->slots().IndexOf(vertex.slot);
    }
  }
}

bool DynamicEdgePool::Evaluate(int edge, const double* const* states, double* residual,
                               double* const* jacobians) const {
  const Entry& item = EntryAt(edge);
  std::vector<VertexRef> refs(item.vertices.size());
  for (std::size_t i = 0; i < refs.size(); ++i) {
    refs[i] = {&item.vertices[i].pool->ops(), states[i]};
  }
  if (!item.edge->Evaluate(refs, residual, jacobians)) return false;
  double poison = 0.0;
  const int rows = item.edge->ResidualDim();
  for (int k = 0; k < rows; ++k)
    poison += 0.0 * residual[k];
  for (std::size_t i = 0; jacobians != nullptr && i < refs.size(); ++i) {
    if (jacobians[i] == nullptr) continue;
    const int size = rows * refs[i].ops->tangent_dim;
    for (int k = 0; k < size; ++k)
      poison += 0.0 * jacobians[i][k];
  }
  return poison == 0.0;
}

double DynamicEdgePool::Chi2(int edge) const {
  const Entry& item = EntryAt(edge);
  std::vector<VertexRef> refs(item.vertices.size());
  for (std::size_t i = 0; i < refs.size(); ++i) {
    VertexPoolBase* pool = item.vertices[i].pool;
    refs[i] = {&pool->ops(), pool->Data(pool->slots().IndexOf(item.vertices[i].slot))};
  }
  double s = 0.0;
  if (item.edge->ConstantHessian() != nullptr) {
    if (!item.edge->LinearizeQuadratic(refs, nullptr, &s)) s = NAN;
    return s;
  }
  std::vector<double> r(static_cast<std::size_t>(item.edge->ResidualDim()));
  if (!item.edge->Evaluate(refs, r.data(), nullptr)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  for (const double value : r)
    s += value * value;
  return s;
}

std::int64_t DynamicEdgePool::MemoryBytes() const {
  std::size_t bytes = items_.capacity() * sizeof(Entry);
  for (const Entry& entry : items_) {
    bytes += entry.vertices.size() * (sizeof(Vertex) + sizeof(VertexRef)) +
             (entry.residual.size() + entry.jacobian.size()) * sizeof(double);
  }
  return slots_.MemoryBytes() + static_cast<std::int64_t>(bytes);
}

void DynamicEdgePool::Compact() {
  if (slots_.NumAlive() == size()) return;
  slots_.Compact([this](int from, int to) {
    const auto f = static_cast<std::size_t>(from), t = static_cast<std::size_t>(to);
    std::swap(items_[t], items_[f]);
    loss_of_edge_[t] = loss_of_edge_[f];
  });
  while (items_.size() > static_cast<std::size_t>(slots_.Size())) {
    items_.back().edge.reset();
    spare_.push_back(std::move(items_.back()));
    items_.pop_back();
  }
  loss_of_edge_.resize(static_cast<std::size_t>(slots_.Size()));
  lists_.Clear();
  for (int edge = 0; edge < size(); ++edge)
    Link(edge);
}

std::unique_ptr<EdgePoolBase> DynamicEdgePool::Clone(
    const std::vector<std::unique_ptr<VertexPoolBase>>& vertex_pools, AnyEdge* failed) const {
  auto copy = std::make_unique<DynamicEdgePool>();
  copy->slots_ = slots_;
  copy->losses_ = losses_;
  copy->loss_of_edge_ = loss_of_edge_;
  copy->lists_ = lists_;
  copy->lists_.Rebind(vertex_pools);
  copy->items_.resize(items_.size());
  for (std::size_t k = 0; k < items_.size(); ++k) {
    Entry& item = copy->items_[k];
    item.vertices = items_[k].vertices;
    for (Vertex& vertex : item.vertices) {
      for (const auto& pool : vertex_pools) {
        if (pool->ops().type == vertex.pool->ops().type) vertex.pool = pool.get();
      }
    }
    // What has been removed has no edge left to copy; the next Compact() closes its gap.
    const int edge = static_cast<int>(k);
    if (!Alive(edge)) continue;
    item.edge = items_[k].edge->Clone();
    if (item.edge == nullptr) {
      *failed = HandleAt(edge);
      return nullptr;
    }
    copy->PrepareItem(&item);
  }
  return copy;
}

}  // namespace glissade
