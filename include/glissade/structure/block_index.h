// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace glissade {

/// A block of a symmetric block matrix by the numbers of its block row and column, row >= col.
struct BlockIndex {
  std::int32_t row = 0;
  std::int32_t col = 0;
};

}  // namespace glissade
