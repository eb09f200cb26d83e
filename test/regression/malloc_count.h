// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace glissade::test {

/// Calls of malloc and its relatives in this program so far; -1 where they cannot be counted (under
/// sanitizers, which replace malloc themselves, and with C libraries other than glibc).
std::int64_t MallocCount();

}  // namespace glissade::test
