// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace glissade::eval::internal {

/// Nanoseconds from one stamp to a later one; exact for any two of them.
constexpr std::uint64_t Elapsed(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<std::uint64_t>(to_ns) - static_cast<std::uint64_t>(from_ns);
}

/// Nanoseconds between two stamps, whichever is the later.
constexpr std::uint64_t Apart(std::int64_t a_ns, std::int64_t b_ns) {
  return a_ns < b_ns ? Elapsed(a_ns, b_ns) : Elapsed(b_ns, a_ns);
}

}  // namespace glissade::eval::internal
