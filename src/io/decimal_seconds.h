// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace glissade::internal {

/// Nanoseconds of a decimal number of seconds, [+-]digits[.digits][e[+-]digits], exactly; digits
/// beyond the ninth after the point are rounded, half away from zero. Nothing where the text is no
/// such number, or where no int64 holds it.
std::optional<std::int64_t> NanosecondsOf(std::string_view seconds);

/// The same number with nine digits after the point.
std::string SecondsOf(std::int64_t nanoseconds);

}  // namespace glissade::internal
