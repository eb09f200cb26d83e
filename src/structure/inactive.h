// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

namespace glissade {

/// In place of a variable's number: the vertex is fixed and takes no part.
inline constexpr std::int32_t kInactive = std::numeric_limits<std::int32_t>::min();

}  // namespace glissade
