// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "glissade/io/bal.h"
#include "io/byte_source.h"

namespace glissade::internal {

/// Whether a file that begins like this is a BAL problem in binary form.
bool IsBalBinary(std::string_view first_bytes);
/// Reads one. What is not as it must be is refused before memory is taken for what it claims.
Result<BalProblem> ReadBalBinary(ByteSource& source, const std::string& path);
/// Writes one, of a problem that has been checked.
Status WriteBalBinary(const BalProblem& problem, const std::string& path);

/// kInvalidArgument or kNotFinite where a problem is none: empty, an index out of range, a number
/// that is not finite.
Status CheckBal(const BalProblem& problem);

}  // namespace glissade::internal
