// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/vertex_pool.h"
#include "glissade/graph/pools.h"

namespace glissade {

VertexPoolBase::VertexPoolBase(const VertexOps& ops)
    : ops_(&ops),
      first_estimates_(ops.ambient_dim),
      values_(ops.value),
      saved_(ops.value),
      stride_(ops.value.size) {}

VertexPoolBase::VertexPoolBase(const VertexPoolBase& other)
    : ops_(other.ops_),
      id_(other.id_),
      slots_(other.slots_),
      fix_(other.fix_),
      eliminated_(other.eliminated_),
      first_estimates_(other.first_estimates_),
      values_(other.values_),
      saved_(other.ops_->value),
      stride_(other.stride_) {
  Rebase();
}

VertexPoolBase::~VertexPoolBase() = default;

void VertexPoolBase::Rebase() {
  base_ = values_.size() == 0
              ? nullptr
              : reinterpret_cast<std::byte*>(const_cast<double*>(ops_->data(values_.data())));
}

AnyVertex VertexPoolBase::Add(const void* vertex, std::uint64_t stamp, std::uint32_t graph) {
  values_.Add(vertex);
  fix_.push_back(Fix::kFree);
  eliminated_.push_back(ops_->eliminated ? 1 : 0);
  const auto address = slots_.Add(stamp, graph);
  first_estimates_.Resize(slots_.Size());
  Rebase();
  return {ops_->type, address.slot, address.generation, graph};
}

void VertexPoolBase::Reserve(std::size_t count) {
  slots_.MakeRoom(count);
  values_.MakeRoom(count);
  Rebase();
  internal::MakeRoomIn(&fix_, count);
  internal::MakeRoomIn(&eliminated_, count);
  first_estimates_.MakeRoom(count);
}

void VertexPoolBase::Assign(int index, const void* vertex) {
  values_.Assign(static_cast<std::size_t>(index), vertex);
  Rebase();
}

void VertexPoolBase::Compact() {
  if (slots_.NumAlive() == size()) return;
  slots_.Compact([this](int from, int to) {
    const auto f = static_cast<std::size_t>(from), t = static_cast<std::size_t>(to);
    values_.Move(f, t);
    fix_[t] = fix_[f];
    eliminated_[t] = eliminated_[f];
    first_estimates_.Move(from, to);
  });
  const auto n = static_cast<std::size_t>(slots_.Size());
  values_.Truncate(n);
  fix_.resize(n);
  eliminated_.resize(n);
  first_estimates_.Resize(slots_.Size());
  Rebase();
}

}  // namespace glissade
