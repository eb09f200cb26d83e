// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>
#include <utility>

/// \file
/// Values of a type that is known at run time only, one after the other as in a std::vector. What
/// is kept by type (pools) is then compiled once, in the library, and not for each type in each
/// unit.
namespace glissade::internal {

/// A copyable type at run time. Null functions: a copy of the bytes does.
struct ValueOps {
  std::size_t size;
  std::size_t alignment;
  void (*copy)(const void* from, void* to);  ///< makes *to
  void (*move)(void* from, void* to);        ///< makes *to; a copy where moving could throw
  void (*assign)(void* from, void* to);      ///< *to = std::move(*from)
  void (*destroy)(void*);
};

template <class T>
constexpr ValueOps ValueOpsOf() {
  ValueOps ops{sizeof(T), alignof(T), nullptr, nullptr, nullptr, nullptr};
  if constexpr (!std::is_trivially_copyable_v<T>) {
    ops.copy = [](const void* from, void* to) { ::new (to) T(*static_cast<const T*>(from)); };
    ops.assign = [](void* from, void* to) {
      *static_cast<T*>(to) = std::move(*static_cast<T*>(from));
    };
    if constexpr (!std::is_trivially_destructible_v<T>) {
      ops.move = [](void* from, void* to) {
        ::new (to) T(std::move_if_noexcept(*static_cast<T*>(from)));
      };
      ops.destroy = [](void* value) { static_cast<T*>(value)->~T(); };
    } else {  // nothing to be robbed of
      ops.move = [](void* from, void* to) { ::new (to) T(*static_cast<const T*>(from)); };
    }
  }
  return ops;
}

class ValueArray {
 public:
  /// ops: must outlive the array.
  explicit ValueArray(const ValueOps& ops) : ops_(&ops) {}
  ValueArray(const ValueArray& other);
  ValueArray& operator=(const ValueArray&) = delete;
  ~ValueArray();

  [[nodiscard]] std::size_t size() const { return size_; }
  /// Of the room that there is.
  [[nodiscard]] std::int64_t MemoryBytes() const {
    return static_cast<std::int64_t>(capacity_ * ops_->size);
  }
  [[nodiscard]] const void* data() const { return data_; }
  [[nodiscard]] void* data() { return data_; }
  [[nodiscard]] const void* At(std::size_t k) const { return data_ + k * ops_->size; }
  [[nodiscard]] void* At(std::size_t k) { return data_ + k * ops_->size; }

  /// The next `count` calls of Add() will not allocate. Where moving the values throws, they are
  /// where they were.
  void MakeRoom(std::size_t count) {
    if (capacity_ - size_ < count) Grow(count);
  }
  /// A copy of a value at the end; where that throws, nothing has been added. MakeRoom() first.
  void Add(const void* value);
  /// The values of another array of the type, whose room is kept.
  void CopyFrom(const ValueArray& other);
  /// Value k becomes a copy of another; where that throws, it stays what it was. May allocate where
  /// a copy is more than its bytes.
  void Assign(std::size_t k, const void* value);
  /// Value `to` becomes what value `from` was.
  void Move(std::size_t from, std::size_t to);
  /// Drops all but the first `size` values.
  void Truncate(std::size_t size);

 private:
  void Grow(std::size_t count);
  void Free();
  [[nodiscard]] std::byte* Allocate(std::size_t count) const;

  const ValueOps* ops_;
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace glissade::internal
