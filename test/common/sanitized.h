// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glissade::test {

/// Built with AddressSanitizer or ThreadSanitizer: ten times slower, so that tests over many random
/// graphs take fewer. The numbers are for the other builds to check.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace glissade::test
