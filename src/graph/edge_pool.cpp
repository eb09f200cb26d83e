// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/edge_pool.h"
#include "glissade/graph/pools.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "graph/small_blocks.h"

namespace glissade {

EdgePool::EdgePool(const EdgeOps& ops,
                   const std::vector<std::unique_ptr<VertexPoolBase>>& vertex_pools)
    : EdgePoolBase(ops.type, ops.traits, ops.arity),
      ops_(&ops),
      arity_(ops.arity),
      rows_(ops.rows),
      wide_(ops.rows >= 8),
      edges_(ops.value) {
  Bind(vertex_pools);
  for (int i = 0; i < arity_; ++i) {
    column_[i] = lists_.ColumnOf(pools_[i]);
    dim_[i] = pools_[i]->ops().tangent_dim;
    dims_ += dim_[i];
    wide_ = wide_ && dim_[i] > 4;
  }
}

void EdgePool::Bind(const std::vector<std::unique_ptr<VertexPoolBase>>& vertex_pools) {
  for (int i = 0; i < arity_; ++i) {
    for (const auto& pool : vertex_pools) {
      if (pool->ops().type == ops_->vertex_types[i]) pools_[i] = pool.get();
    }
  }
}

AnyEdge EdgePool::Add(const void* edge, const AnyVertex* vertices, const double* sqrt_information,
                      bool identity, const Loss& loss, std::uint64_t stamp, std::uint32_t graph) {
  const std::uint32_t loss_index = FindOrAddLoss(loss);
  edges_.Add(edge);
  for (int i = 0; i < arity_; ++i)
    vertices_.push_back(vertices[i].slot);
  if (!identity || !sqrt_information_.empty()) {
    sqrt_information_.insert(sqrt_information_.end(), sqrt_information,
                             sqrt_information + rows_ * rows_);
  }
  identity_.push_back(identity ? 1 : 0);
  loss_of_edge_.push_back(loss_index);
  const auto address = slots_.Add(stamp, graph);
  Link(size() - 1);
  return {type_, address.slot, address.generation, graph};
}

bool EdgePool::CanJoin(const AnyVertex* vertices) const {
  int eliminated = 0;
  for (int i = 0; i < arity_; ++i) {
    const VertexPoolBase& pool = *pools_[i];
    if (vertices[i].type != pool.ops().type || !pool.slots().Contains(vertices[i])) return false;
    if (pool.eliminated(pool.slots().IndexOf(vertices[i].slot)) && ++eliminated == 2) return false;
    for (int j = 0; j < i; ++j) {
      if (pools_[j] == &pool && vertices[j].slot == vertices[i].slot) return false;
    }
  }
  return true;
}

// From now on there is a weight for each edge.
void EdgePool::KeepWeights() {
  const std::size_t rows = internal::Index(rows_), count = internal::Index(size());
  if (!sqrt_information_.empty() || count == 0) return;
  std::vector<double> weights(count * rows * rows, 0.0);
  for (std::size_t k = 0; k < count * rows; ++k)
    weights[k * rows + k % rows] = 1.0;
  sqrt_information_ = std::move(weights);
}

void EdgePool::Reserve(std::size_t count, bool identity) {
  slots_.MakeRoom(count);
  edges_.MakeRoom(count);
  internal::MakeRoomIn(&vertices_, count * internal::Index(arity_));
  if (!identity) KeepWeights();
  if (!identity || !sqrt_information_.empty())
    internal::MakeRoomIn(&sqrt_information_, count * internal::Index(rows_ * rows_));
  internal::MakeRoomIn(&identity_, count);
  internal::MakeRoomIn(&loss_of_edge_, count);
  lists_.MakeRoomForLinks(count * internal::Index(arity_));
}

void EdgePool::RoomAt(const AnyVertex* vertices) {
  for (int i = 0; i < arity_; ++i)
    lists_.MakeRoom(column_[i], vertices[i].slot);
}

void EdgePool::set_sqrt_information(int edge, const double* value, bool identity) {
  if (identity && sqrt_information_.empty()) return;
  KeepWeights();
  const std::size_t size = internal::Index(rows_ * rows_);
  std::copy_n(value, size, sqrt_information_.data() + internal::Index(edge) * size);
  identity_[internal::Index(edge)] = identity ? 1 : 0;
}

void EdgePool::Link(int edge) {
  const std::uint32_t* slots = vertices_.data() + internal::Index(edge) * internal::Index(arity_);
  for (int i = 0; i < arity_; ++i)
    lists_.Append(column_[i], slots[i], edge);
}

void EdgePool::DenseIndices(int edge, std::int32_t* indices) const {
  const std::uint32_t* slots = vertices_.data() + internal::Index(edge) * internal::Index(arity_);
  for (int i = 0; i < arity_; ++i)
    indices[i] = pools_[i]->slots().IndexOf(slots[i]);
}

void EdgePool::AllDenseIndices(std::int32_t* indices) const {
  for (int edge = 0; edge < size(); ++edge, indices += arity_)
    DenseIndices(edge, indices);
}

void EdgePool::States(const std::int32_t* indices, const double** states) const {
  for (int i = 0; i < arity_; ++i)
    states[i] = static_cast<const VertexPoolBase*>(pools_[i])->Data(indices[i]);
}

bool EdgePool::Evaluate(int edge, const double* const* states, double* residual,
                        double* const* jacobians) const {
  if (!ops_->evaluate(Value(edge), states, residual, jacobians)) return false;
  double poison = internal::Poison(rows_, residual);
  for (int i = 0; jacobians != nullptr && i < arity_; ++i) {
    if (jacobians[i] != nullptr) poison += internal::Poison(rows_ * dim_[i], jacobians[i]);
  }
  return poison == 0.0;
}

bool EdgePool::SameInRun(int edge, int other) const {
  return ops_->same_in_run == nullptr || ops_->same_in_run(Value(edge), Value(other));
}

void EdgePool::Whiten(int edge, double* residual, double* const* jacobians) const {
  if (HasIdentityInformation(edge)) return;
  const double* L = sqrt_information(edge);
  int widest = 1;
  for (int i = 0; i < arity_; ++i)
    widest = std::max(widest, dim_[i]);
  auto* work =
      static_cast<double*>(__builtin_alloca(sizeof(double) * internal::Index(rows_ * widest)));
  internal::MultiplyInPlace(rows_, 1, L, residual, work);
  for (int i = 0; jacobians != nullptr && i < arity_; ++i) {
    if (jacobians[i] != nullptr) internal::MultiplyInPlace(rows_, dim_[i], L, jacobians[i], work);
  }
}

double EdgePool::Chi2(int edge) const {
  std::int32_t indices[kMaxTypedArity];
  const double* states[kMaxTypedArity];
  DenseIndices(edge, indices);
  States(indices, states);
  auto* scratch =
      static_cast<double*>(__builtin_alloca(sizeof(double) * internal::Index(2 * rows_)));
  return WhitenedSquaredNorm(edge, states, scratch);
}

bool EdgePool::Depth(int edge, double* depth) const {
  if (ops_->depth == nullptr) return false;
  std::int32_t indices[kMaxTypedArity];
  const double* states[kMaxTypedArity];
  DenseIndices(edge, indices);
  States(indices, states);
  *depth = ops_->depth(Value(edge), states);
  return true;
}

const double* EdgePool::Extrinsic(int edge) const {
  return ops_->extrinsic == nullptr ? nullptr : ops_->extrinsic(Value(edge));
}

bool EdgePool::TwoView(int edge, TwoViewObservation* observation) const {
  if (ops_->two_view == nullptr) return false;
  ops_->two_view(Value(edge), observation);
  return true;
}

bool EdgePool::IsDuplicate(int edge, int other) const {
  if (!traits_->is_observation) return false;
  return ops_->same_sensor == nullptr || ops_->same_sensor(Value(edge), Value(other));
}

std::int64_t EdgePool::MemoryBytes() const {
  const std::size_t of_vectors = sizeof(std::uint32_t) * (vertices_.capacity() * 2 +  // and links
                                                          loss_of_edge_.capacity()) +
                                 sizeof(double) * sqrt_information_.capacity() +
                                 identity_.capacity();
  return edges_.MemoryBytes() + slots_.MemoryBytes() + static_cast<std::int64_t>(of_vectors);
}

void EdgePool::Compact() {
  if (slots_.NumAlive() == size()) return;
  const std::size_t arity = internal::Index(arity_), weights = internal::Index(rows_ * rows_);
  slots_.Compact([&](int from, int to) {
    const std::size_t f = internal::Index(from), t = internal::Index(to);
    edges_.Move(f, t);
    std::copy_n(vertices_.data() + f * arity, arity, vertices_.data() + t * arity);
    if (!sqrt_information_.empty()) {
      std::copy_n(sqrt_information_.data() + f * weights, weights,
                  sqrt_information_.data() + t * weights);
    }
    identity_[t] = identity_[f];
    loss_of_edge_[t] = loss_of_edge_[f];
  });
  const std::size_t n = internal::Index(slots_.Size());
  edges_.Truncate(n);
  vertices_.resize(n * arity);
  if (!sqrt_information_.empty()) sqrt_information_.resize(n * weights);
  identity_.resize(n);
  loss_of_edge_.resize(n);
  lists_.Clear();
  for (int edge = 0; edge < size(); ++edge)
    Link(edge);
}

std::unique_ptr<EdgePoolBase> EdgePool::Clone(
    const std::vector<std::unique_ptr<VertexPoolBase>>& vertex_pools, AnyEdge*) const {
  auto copy = std::make_unique<EdgePool>(*this);
  copy->Bind(vertex_pools);
  copy->lists_.Rebind(vertex_pools);
  return copy;
}

}  // namespace glissade
