// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "glissade/graph/slot_map.h"

namespace glissade {

/// x_lin of the vertices of one pool: those that a marginal prior touches. Empty, and without
/// storage, as long as there are none.
class LinearizationTable {
 public:
  explicit LinearizationTable(int ambient_dim) : dim_(static_cast<std::size_t>(ambient_dim)) {}

  /// ambient_dim numbers, or null where the vertex with this dense index has no x_lin.
  [[nodiscard]] const double* At(int index) const {
    if (count_ == 0 || has_[static_cast<std::size_t>(index)] == 0) return nullptr;
    return x_.data() + static_cast<std::size_t>(index) * dim_;
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] int count() const { return count_; }

  /// size: of the pool.
  void Set(int index, int size, const double* x) {
    if (count_ == 0) {
      has_.assign(static_cast<std::size_t>(size), 0);
      x_.resize(static_cast<std::size_t>(size) * dim_);
    }
    const auto k = static_cast<std::size_t>(index);
    if (has_[k] == 0) ++count_;
    has_[k] = 1;
    std::copy_n(x, dim_, x_.data() + k * dim_);
  }
  void Drop(int index) {
    if (count_ == 0 || has_[static_cast<std::size_t>(index)] == 0) return;
    has_[static_cast<std::size_t>(index)] = 0;
    --count_;
  }

  // The pool has moved a value, or has another size.
  void Move(int from, int to) {
    if (count_ == 0) return;
    const auto f = static_cast<std::size_t>(from), t = static_cast<std::size_t>(to);
    has_[t] = has_[f];
    std::copy_n(x_.data() + f * dim_, dim_, x_.data() + t * dim_);
  }
  void MakeRoom(std::size_t more) {
    if (count_ == 0) return;
    internal::MakeRoomIn(&has_, more);
    internal::MakeRoomIn(&x_, more * dim_);
  }
  void Resize(int size) {
    if (count_ == 0) return;
    has_.resize(static_cast<std::size_t>(size), 0);
    x_.resize(static_cast<std::size_t>(size) * dim_);
  }

 private:
  std::size_t dim_;
  int count_ = 0;
  std::vector<std::uint8_t> has_;
  std::vector<double> x_;
};

}  // namespace glissade
