// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "glissade/base/handle.h"

namespace glissade::internal {

template <class T>
void GrowBy(std::vector<T>* items, std::size_t count) {
  const std::size_t least = items->size() + count, twice = 2 * items->size();
  items->reserve(std::max(std::max(least, twice), std::size_t{4}));
}

/// The next `count` calls of push_back() will not allocate. Growing is a call of its own, so that
/// the question alone is compiled into the loops that add.
template <class T>
inline void MakeRoomIn(std::vector<T>* items, std::size_t count = 1) {
  if (items->capacity() - items->size() < count) GrowBy(items, count);
}

/// Maps stable slots (what handles hold) to dense indices (where values lie).
///
/// Values are appended and never reordered; removal only marks, and Compact() closes the gaps
/// stably. So the dense order is always the insertion order of what is alive, and results do not
/// depend on what was removed before.
class SlotMap {
 public:
  struct Address {
    std::uint32_t slot;
    std::uint32_t generation;
  };

  SlotMap() = default;
  SlotMap(SlotMap&&) noexcept = default;
  SlotMap& operator=(SlotMap&&) noexcept = default;
  SlotMap& operator=(const SlotMap& other) { return *this = SlotMap(other); }
  SlotMap(const SlotMap& other)
      : index_of_slot_(other.index_of_slot_),
        generation_of_slot_(other.generation_of_slot_),
        graph_of_slot_(other.graph_of_slot_),
        slot_of_index_(other.slot_of_index_),
        alive_(other.alive_),
        stamp_(other.stamp_),
        num_alive_(other.num_alive_) {
    // A copied vector has no room; Remove() needs it.
    free_slots_.reserve(index_of_slot_.size());
    free_slots_.assign(other.free_slots_.begin(), other.free_slots_.end());
  }

  /// stamp: a number that does not fall from one insertion into the graph to the next. graph: the
  /// id of the graph that it is added to, which a copy of this map keeps: what is added to the copy
  /// later has another one, and so other handles than what the original is given. MakeRoom() comes
  /// first: this does not allocate.
  Address Add(std::uint64_t stamp, std::uint32_t graph) {
    std::uint32_t slot;
    if (free_slots_.empty()) {
      slot = static_cast<std::uint32_t>(index_of_slot_.size());
      index_of_slot_.push_back(0);
      generation_of_slot_.push_back(0);
      graph_of_slot_.push_back(0);
    } else {
      slot = free_slots_.back();
      free_slots_.pop_back();
    }
    index_of_slot_[slot] = static_cast<std::uint32_t>(slot_of_index_.size());
    graph_of_slot_[slot] = graph;
    slot_of_index_.push_back(slot);
    alive_.push_back(1);
    stamp_.push_back(stamp);
    ++num_alive_;
    return {slot, generation_of_slot_[slot]};
  }

  /// The next `count` calls of Add() will not allocate.
  void MakeRoom(std::size_t count = 1) {
    MakeRoomIn(&slot_of_index_, count);
    MakeRoomIn(&alive_, count);
    MakeRoomIn(&stamp_, count);
    if (free_slots_.size() >= count) return;
    const std::size_t fresh = count - free_slots_.size();
    MakeRoomIn(&index_of_slot_, fresh);
    MakeRoomIn(&generation_of_slot_, fresh);
    MakeRoomIn(&graph_of_slot_, fresh);
    // Room for every slot to be freed: Remove() must not allocate.
    free_slots_.reserve(index_of_slot_.capacity());
  }

  void Remove(std::uint32_t slot) {
    alive_[index_of_slot_[slot]] = 0;
    ++generation_of_slot_[slot];
    free_slots_.push_back(slot);
    --num_alive_;
  }

  /// Takes the youngest entry back as if it had never been added; its handles are dead. Whether
  /// `slot` is the youngest: IsLast().
  void PopLast() {
    const std::uint32_t slot = slot_of_index_.back();
    ++generation_of_slot_[slot];
    free_slots_.push_back(slot);
    if (alive_.back() != 0) --num_alive_;
    slot_of_index_.pop_back();
    alive_.pop_back();
    stamp_.pop_back();
  }
  [[nodiscard]] bool IsLast(std::uint32_t slot) const {
    return !slot_of_index_.empty() && slot_of_index_.back() == slot && alive_.back() != 0;
  }

  [[nodiscard]] bool Contains(std::uint32_t slot, std::uint32_t generation) const {
    if (slot >= index_of_slot_.size() || generation_of_slot_[slot] != generation) return false;
    const std::uint32_t index = index_of_slot_[slot];
    return index < slot_of_index_.size() && slot_of_index_[index] == slot && alive_[index] != 0;
  }

  /// What a caller's handle stands for: of this graph too.
  template <class Handle>
  [[nodiscard]] bool Contains(const Handle& handle) const {
    return Contains(handle.slot, handle.generation) && graph_of_slot_[handle.slot] == handle.graph;
  }
  /// Whether a handle was good once: of an entry that has been removed.
  template <class Handle>
  [[nodiscard]] bool Contained(const Handle& handle) const {
    return handle.slot < generation_of_slot_.size() &&
           handle.generation < generation_of_slot_[handle.slot] &&
           graph_of_slot_[handle.slot] == handle.graph;
  }

  [[nodiscard]] int IndexOf(std::uint32_t slot) const {
    return static_cast<int>(index_of_slot_[slot]);
  }
  [[nodiscard]] std::uint32_t SlotOf(int index) const {
    return slot_of_index_[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] std::uint32_t GenerationOf(std::uint32_t slot) const {
    return generation_of_slot_[slot];
  }
  [[nodiscard]] std::uint32_t GraphOf(std::uint32_t slot) const { return graph_of_slot_[slot]; }
  [[nodiscard]] bool AliveAt(int index) const {
    return alive_[static_cast<std::size_t>(index)] != 0;
  }
  /// Number of dense entries, dead ones included until Compact().
  [[nodiscard]] int Size() const { return static_cast<int>(slot_of_index_.size()); }
  [[nodiscard]] int NumAlive() const { return num_alive_; }
  /// Stamp of the oldest entry, dead ones included until Compact(); the largest number if empty.
  [[nodiscard]] std::uint64_t FirstStamp() const {
    return stamp_.empty() ? ~std::uint64_t{0} : stamp_.front();
  }

  /// About what it takes.
  [[nodiscard]] std::int64_t MemoryBytes() const {
    return static_cast<std::int64_t>(index_of_slot_.capacity() * 5 * sizeof(std::uint32_t) +
                                     stamp_.capacity() * (sizeof(std::uint64_t) + 1));
  }

  /// Closes gaps; calls move(from, to) with to < from for every value that moves, in order.
  template <class Move>
  void Compact(Move&& move) {
    if (num_alive_ == Size()) return;
    std::size_t to = 0;
    for (std::size_t from = 0; from < slot_of_index_.size(); ++from) {
      if (alive_[from] == 0) continue;
      if (to != from) {
        move(static_cast<int>(from), static_cast<int>(to));
        slot_of_index_[to] = slot_of_index_[from];
        index_of_slot_[slot_of_index_[to]] = static_cast<std::uint32_t>(to);
        alive_[to] = 1;
        stamp_[to] = stamp_[from];
      }
      ++to;
    }
    slot_of_index_.resize(to);
    alive_.resize(to);
    stamp_.resize(to);
  }

 private:
  std::vector<std::uint32_t> index_of_slot_;
  std::vector<std::uint32_t> generation_of_slot_;
  std::vector<std::uint32_t> graph_of_slot_;  ///< that its last entry was added to
  std::vector<std::uint32_t> slot_of_index_;
  std::vector<std::uint8_t> alive_;
  std::vector<std::uint64_t> stamp_;
  std::vector<std::uint32_t> free_slots_;
  int num_alive_ = 0;
};

}  // namespace glissade::internal
