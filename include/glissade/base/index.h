// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace glissade::internal {

/// A count or position that is never negative, as what subscripts of the standard library take.
constexpr std::size_t Index(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

}  // namespace glissade::internal
