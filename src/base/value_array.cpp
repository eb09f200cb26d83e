// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/value_array.h"

#include <algorithm>
#include <cstring>

namespace glissade::internal {

ValueArray::ValueArray(const ValueArray& other) : ops_(other.ops_) {
  if (other.size_ == 0) return;
  data_ = Allocate(other.size_);
  capacity_ = other.size_;
  if (ops_->copy == nullptr) {
    std::memcpy(data_, other.data_, other.size_ * ops_->size);
    size_ = other.size_;
    return;
  }
  try {
    for (; size_ < other.size_; ++size_)
      ops_->copy(other.At(size_), At(size_));
  } catch (...) {
    Free();
    throw;
  }
}

ValueArray::~ValueArray() {
  Free();
}

std::byte* ValueArray::Allocate(std::size_t count) const {
  return static_cast<std::byte*>(
      ::operator new(count * ops_->size, std::align_val_t(ops_->alignment)));
}

void ValueArray::Free() {
  Truncate(0);
  ::operator delete(data_, std::align_val_t(ops_->alignment));
  data_ = nullptr;
  capacity_ = 0;
}

void ValueArray::Grow(std::size_t count) {
  const std::size_t room = std::max({size_ + count, 2 * size_, std::size_t{4}});
  std::byte* const grown = Allocate(room);
  if (ops_->move == nullptr) {
    if (size_ > 0) std::memcpy(grown, data_, size_ * ops_->size);
  } else {
    std::size_t done = 0;
    try {
      for (; done < size_; ++done)
        ops_->move(At(done), grown + done * ops_->size);
    } catch (...) {  // a copy: what it was made from is as it was
      for (std::size_t k = 0; k < done && ops_->destroy != nullptr; ++k)
        ops_->destroy(grown + k * ops_->size);
      ::operator delete(grown, std::align_val_t(ops_->alignment));
      throw;
    }
  }
  const std::size_t size = size_;
  Free();
  data_ = grown;
  size_ = size;
  capacity_ = room;
}

void ValueArray::Add(const void* value) {
  if (ops_->copy == nullptr) {
    std::memcpy(At(size_), value, ops_->size);
  } else {
    ops_->copy(value, At(size_));
  }
  ++size_;
}

void ValueArray::CopyFrom(const ValueArray& other) {
  Truncate(0);
  MakeRoom(other.size_);
  if (ops_->copy != nullptr) {
    while (size_ < other.size_)
      Add(other.At(size_));
    return;
  }
  if (other.size_ > 0) std::memcpy(data_, other.data_, other.size_ * ops_->size);
  size_ = other.size_;
}

void ValueArray::Assign(std::size_t k, const void* value) {
  if (ops_->copy == nullptr) {
    std::memcpy(At(k), value, ops_->size);
    return;
  }
  MakeRoom(1);
  Add(value);
  Move(size_ - 1, k);
  Truncate(size_ - 1);
}

void ValueArray::Move(std::size_t from, std::size_t to) {
  if (from == to) return;
  if (ops_->assign == nullptr) {
    std::memcpy(At(to), At(from), ops_->size);
  } else {
    ops_->assign(At(from), At(to));
  }
}

void ValueArray::Truncate(std::size_t size) {
  if (ops_->destroy == nullptr) {
    size_ = std::min(size_, size);
    return;
  }
  while (size_ > size)
    ops_->destroy(At(--size_));
}

}  // namespace glissade::internal
