// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "glissade/graph/first_estimates.h"
#include "glissade/graph/fix.h"
#include "glissade/graph/slot_map.h"
#include "glissade/vertices/concept.h"

namespace glissade {

/// All vertices of one type, contiguous. This base gives access to states as raw doubles; values as
/// themselves are in VertexPool<V>.
class VertexPoolBase {
 public:
  explicit VertexPoolBase(const VertexOps& ops) : ops_(&ops), first_estimates_(ops.ambient_dim) {}
  virtual ~VertexPoolBase() = default;

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

  /// x(index) <- x(index) boxplus delta for count vertices; delta of the k-th is step + offset[k],
  /// vertices with offset[k] < 0 stay.
  virtual void Plus(const double* step, const std::int32_t* offset, int count) = 0;
  /// Keeps a copy of all states / goes back to it.
  virtual void Save() = 0;
  virtual void Restore() = 0;
  virtual void Compact() = 0;
  [[nodiscard]] virtual std::unique_ptr<VertexPoolBase> Clone() const = 0;

 protected:
  const VertexOps* ops_;
  int id_ = 0;
  internal::SlotMap slots_;
  std::vector<Fix> fix_;
  std::vector<std::uint8_t> eliminated_;
  LinearizationTable first_estimates_;
  std::byte* base_ = nullptr;
  std::size_t stride_ = 0;
};

template <VertexType V>
class VertexPool final : public VertexPoolBase {
 public:
  // What adding needs is defined below and not inline: with pools of built-in types compiled in the
  // library (builtin_vertices.h), a consumer's unit then compiles nothing of them.
  VertexPool();
  VertexPool(const VertexPool& other) : VertexPoolBase(other), values_(other.values_) { Rebase(); }

  /// stamp, graph: see SlotMap. Reserve() comes first, and all that can run out of memory with it.
  VertexHandle<V> Add(const V& value, std::uint64_t stamp, std::uint32_t graph);
  /// Room for `count` more: adding them will not allocate.
  void Reserve(std::size_t count);

  [[nodiscard]] const V& At(int index) const { return values_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] V& At(int index) { return values_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] const V* values() const { return values_.data(); }

  void Plus(const double* step, const std::int32_t* offset, int count) override {
    for (int k = 0; k < count; ++k) {
      if (offset[k] >= 0) values_[static_cast<std::size_t>(k)].Plus(step + offset[k]);
    }
  }
  void Save() override { saved_ = values_; }
  void Restore() override { values_ = saved_; }

  void Compact() override {
    if (slots_.NumAlive() == size()) return;
    slots_.Compact([this](int from, int to) {
      const auto f = static_cast<std::size_t>(from), t = static_cast<std::size_t>(to);
      values_[t] = values_[f];
      fix_[t] = fix_[f];
      eliminated_[t] = eliminated_[f];
      first_estimates_.Move(from, to);
    });
    const auto n = static_cast<std::size_t>(slots_.Size());
    values_.resize(n);
    fix_.resize(n);
    eliminated_.resize(n);
    first_estimates_.Resize(slots_.Size());
    Rebase();
  }

  [[nodiscard]] std::unique_ptr<VertexPoolBase> Clone() const override {
    return std::make_unique<VertexPool>(*this);
  }

 private:
  void Rebase() {
    base_ = values_.empty() ? nullptr : reinterpret_cast<std::byte*>(values_.front().Data());
  }

  std::vector<V> values_;
  std::vector<V> saved_;
};

template <VertexType V>
VertexPool<V>::VertexPool() : VertexPoolBase(kVertexOps<V>) {
  stride_ = sizeof(V);
}

template <VertexType V>
VertexHandle<V> VertexPool<V>::Add(const V& value, std::uint64_t stamp, std::uint32_t graph) {
  values_.push_back(value);
  fix_.push_back(Fix::kFree);
  eliminated_.push_back(kIsEliminated<V> ? 1 : 0);
  const auto address = slots_.Add(stamp, graph);
  first_estimates_.Resize(slots_.Size());
  Rebase();
  return {address.slot, address.generation, graph};
}

template <VertexType V>
void VertexPool<V>::Reserve(std::size_t count) {
  slots_.MakeRoom(count);
  internal::MakeRoomIn(&values_, count);
  Rebase();
  internal::MakeRoomIn(&fix_, count);
  internal::MakeRoomIn(&eliminated_, count);
  first_estimates_.MakeRoom(count);
}

}  // namespace glissade
