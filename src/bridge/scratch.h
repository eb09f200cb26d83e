// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace glissade::bridge {

/// n values, not initialised, on the stack up to Inline: a residual block is evaluated some
/// hundred thousand times a second, and a timing of Ceres should not be one of malloc.
template <class T, std::size_t Inline>
class Scratch {
 public:
  explicit Scratch(std::size_t n) {
    if (n > Inline) {
      heap_.resize(n);
      data_ = heap_.data();
    }
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  [[nodiscard]] T* data() const { return data_; }

 private:
  std::array<T, Inline> stack_;
  std::vector<T> heap_;
  T* data_ = stack_.data();
};

}  // namespace glissade::bridge
