// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>

namespace glissade::internal {

/// Nine significant digits, whatever the size (std::to_string prints 1e-8 as 0.000000).
inline std::string FormatNumber(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof(buffer), "%.9g", x);
  return buffer;
}

}  // namespace glissade::internal
