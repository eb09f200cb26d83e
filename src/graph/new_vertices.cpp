// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What AddVertex, AddVertices and Set do, and how values are found, whatever the type.

#include <string>
#include <utility>

#include "glissade/base/validate.h"
#include "glissade/graph/pools.h"

namespace glissade {

Status Graph::CheckVertex(const VertexOps& ops, const void* value) {
  // Pools reach all states from the first one and the size of a value: the state must lie in it.
  const double* state = ops.data(value);
  const auto* begin = static_cast<const std::byte*>(value);
  const auto* data = reinterpret_cast<const std::byte*>(state);
  if (data < begin ||
      data + sizeof(double) * static_cast<std::size_t>(ops.ambient_dim) > begin + ops.value.size) {
    return internal::About({StatusCode::kInvalidArgument, "Data() must point into the vertex"},
                           ops.type->name);
  }
  if (!internal::AllFinite(state, ops.ambient_dim)) {
    return internal::About({StatusCode::kNotFinite, "state is not finite"}, ops.type->name);
  }
  if (ops.validate_value == nullptr) return {};
  return internal::About(ops.validate_value(value), ops.type->name);
}

VertexPoolBase& Graph::MakePool(const VertexOps& ops) {
  if (VertexPoolBase* pool = PoolOf(ops.type)) return *pool;
  vertex_pools_.push_back(std::make_unique<VertexPoolBase>(ops));
  vertex_pools_.back()->set_id(static_cast<int>(vertex_pools_.size()) - 1);
  return *vertex_pools_.back();
}

Status Graph::AddNewVertex(const NewVertices& vertex) {
  if (Status status = CheckVertex(*vertex.ops, vertex.values); !status.ok()) {
    return Refused(std::move(status));
  }
  StructureChanged();
  VertexPoolBase& pool = MakePool(*vertex.ops);
  pool.Reserve(1);
  vertex.put_handle(vertex.handles, 0, pool.Add(vertex.values, structure_version_, Id()));
  return {};
}

Status Graph::AddNewVertices(const NewVertices& vertices) {
  const auto value = [&](std::size_t k) {
    return static_cast<const std::byte*>(vertices.values) + k * vertices.ops->value.size;
  };
  for (std::size_t k = 0; k < vertices.count; ++k) {
    if (Status status = CheckVertex(*vertices.ops, value(k)); !status.ok()) {
      return Refused(internal::About(status, "value " + std::to_string(k)));
    }
  }
  VertexPoolBase& pool = MakePool(*vertices.ops);
  pool.Reserve(vertices.count);
  StructureChanged();
  for (std::size_t k = 0; k < vertices.count; ++k)
    vertices.put_handle(vertices.handles, k, pool.Add(value(k), structure_version_, Id()));
  return {};
}

Status Graph::SetValue(AnyVertex vertex, const void* value) {
  const VertexSite site = Locate(vertex);
  if (site.pool == nullptr) return Refused(internal::About(UnknownHandle(vertex), "Set"));
  if (Status status = CheckVertex(site.pool->ops(), value); !status.ok()) {
    return Refused({status.code(), status.message(), vertex});
  }
  site.pool->Assign(site.index, value);
  Reanchor(vertex);
  return {};
}

const void* Graph::FindValue(AnyVertex vertex) const {
  const VertexSite site = Locate(vertex);
  return site.pool == nullptr ? nullptr : site.pool->Value(site.index);
}

const void* Graph::FindValue(AnyEdge edge) const {
  const EdgeSite site = Locate(edge);
  return site.pool == nullptr ? nullptr : static_cast<EdgePool*>(site.pool)->Value(site.index);
}

int Graph::NumVerticesOf(const TypeInfo* type) const {
  const VertexPoolBase* pool = PoolOf(type);
  return pool == nullptr ? 0 : pool->slots().NumAlive();
}

int Graph::NumEdgesOf(const TypeInfo* type) const {
  const EdgePoolBase* pool = EdgePoolOf(type);
  return pool == nullptr ? 0 : pool->slots().NumAlive();
}

const void* Graph::NextVertex(const TypeInfo* type, int* index, AnyVertex* handle) const {
  const VertexPoolBase* pool = PoolOf(type);
  while (pool != nullptr && *index < pool->size()) {
    const int k = (*index)++;
    if (!pool->slots().AliveAt(k)) continue;
    *handle = pool->HandleAt(k);
    return pool->Value(k);
  }
  return nullptr;
}

const void* Graph::NextEdge(const TypeInfo* type, int* index, AnyEdge* handle,
                            AnyVertex* vertices) const {
  const EdgePool* pool = TypedEdgePoolOf(type);
  while (pool != nullptr && *index < pool->size()) {
    const int k = (*index)++;
    if (!pool->Alive(k)) continue;
    *handle = pool->HandleAt(k);
    for (int i = 0; vertices != nullptr && i < pool->fixed_arity(); ++i)
      vertices[i] = pool->VertexOf(k, i);
    return pool->Value(k);
  }
  return nullptr;
}

}  // namespace glissade
