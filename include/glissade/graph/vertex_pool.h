// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "glissade/base/value_array.h"
#include "glissade/graph/fix.h"
#include "glissade/graph/linearization_table.h"
#include "glissade/graph/slot_map.h"
#include "glissade/vertices/concept.h"

namespace glissade {

/// All vertices of one type, contiguous. It knows the type by its VertexOps and gives access to
/// states as raw doubles; values as themselves are seen through VertexPool<V>.
class VertexPoolBase {
 public:
  explicit VertexPoolBase(const VertexOps& ops);
  VertexPoolBase(const VertexPoolBase& other);
  VertexPoolBase& operator=(const VertexPoolBase&) = delete;
  ~VertexPoolBase();

  /// stamp, graph: see SlotMap. Reserve() comes first, and all that can run out of memory with it.
  AnyVertex Add(const void* vertex, std::uint64_t stamp, std::uint32_t graph);
  /// Room for `count` more: adding them will not allocate.
  void Reserve(std::size_t count);

  [[nodiscard]] const VertexOps& ops() const { return *ops_; }
  [[nodiscard]] const internal::SlotMap& slots() const { return slots_; }
  [[nodiscard]] int size() const { return slots_.Size(); }
  /// Position among the graph's vertex pools.
  [[nodiscard]] int id() const { return id_; }
  void set_id(int id) { id_ = id; }

  [[nodiscard]] const double* Data(int index) const {
    return reinterpret_cast<const double*>(base_ + static_cast<std::size_t>(index) * stride_);
  }
  [[nodiscard]] double* Data(int index) {
    return reinterpret_cast<double*>(base_ + static_cast<std::size_t>(index) * stride_);
  }
  [[nodiscard]] AnyVertex HandleAt(int index) const {
    const std::uint32_t slot = slots_.SlotOf(index);
    return {ops_->type, slot, slots_.GenerationOf(slot), slots_.GraphOf(slot)};
  }

  [[nodiscard]] Fix fix(int index) const { return fix_[static_cast<std::size_t>(index)]; }
  void set_fix(int index, Fix fix) { fix_[static_cast<std::size_t>(index)] = fix; }
  [[nodiscard]] bool eliminated(int index) const {
    return eliminated_[static_cast<std::size_t>(index)] != 0;
  }
  void set_eliminated(int index, bool on) {
    eliminated_[static_cast<std::size_t>(index)] = on ? 1 : 0;
  }

  /// x_lin of each vertex that has one (first_estimates.h).
  [[nodiscard]] const LinearizationTable& first_estimates() const { return first_estimates_; }
  void SetFirstEstimate(int index, const double* x) { first_estimates_.Set(index, size(), x); }
  void DropFirstEstimate(int index) { first_estimates_.Drop(index); }

  void Remove(std::uint32_t slot) {
    first_estimates_.Drop(slots_.IndexOf(slot));
    slots_.Remove(slot);
  }

  [[nodiscard]] const void* Value(int index) const {
    return values_.At(static_cast<std::size_t>(index));
  }
  [[nodiscard]] void* Value(int index) { return values_.At(static_cast<std::size_t>(index)); }
  void Assign(int index, const void* vertex);

  /// x(index) <- x(index) boxplus delta for count vertices; delta of the k-th is step + offset[k],
  /// vertices with offset[k] < 0 stay.
  void Plus(const double* step, const std::int32_t* offset, int count) {
    ops_->plus_all(values_.data(), step, offset, count);
  }
  /// About what the vertices, a copy of their states and their handles take.
  [[nodiscard]] std::int64_t MemoryBytes() const {
    return 2 * values_.MemoryBytes() + slots_.MemoryBytes() + 2 * std::int64_t{size()};
  }
  /// Keeps a copy of all states / goes back to it.
  void Save() { saved_.CopyFrom(values_); }
  void Restore() {
    values_.CopyFrom(saved_);
    Rebase();
  }
  void Compact();

 private:
  void Rebase();

  const VertexOps* ops_;
  int id_ = 0;
  internal::SlotMap slots_;
  std::vector<Fix> fix_;
  std::vector<std::uint8_t> eliminated_;
  LinearizationTable first_estimates_;
  internal::ValueArray values_;
  internal::ValueArray saved_;
  std::byte* base_ = nullptr;  // state of the first
  std::size_t stride_ = 0;
};

/// The pool of V, which may be none, with values as themselves. Copied like a pointer.
template <VertexType V>
class VertexPool {
 public:
  VertexPool(VertexPoolBase* base = nullptr) : base_(base) {}  // NOLINT: implicit, it is one

  [[nodiscard]] const V& At(int index) const { return *static_cast<const V*>(base_->Value(index)); }
  [[nodiscard]] V& At(int index) { return *static_cast<V*>(base_->Value(index)); }

  [[nodiscard]] int id() const { return base_->id(); }
  [[nodiscard]] int size() const { return base_->size(); }
  [[nodiscard]] const internal::SlotMap& slots() const { return base_->slots(); }
  [[nodiscard]] double* Data(int index) const { return base_->Data(index); }
  [[nodiscard]] AnyVertex HandleAt(int index) const { return base_->HandleAt(index); }
  [[nodiscard]] const LinearizationTable& first_estimates() const {
    return base_->first_estimates();
  }

  VertexPool operator*() const { return *this; }
  const VertexPool* operator->() const { return this; }
  friend bool operator==(const VertexPool& pool, std::nullptr_t) { return pool.base_ == nullptr; }

 private:
  VertexPoolBase* base_;
};

}  // namespace glissade
