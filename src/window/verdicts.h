// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "glissade/window/init_verdict.h"

namespace glissade::internal {

/// "what: figure unit, limit limit unit".
inline InitVerdict Refusal(InitReason reason, double figure, double limit, const char* what,
                           const char* unit) {
  std::array<char, 256> line;
  std::snprintf(line.data(), line.size(), ": %s is %.4g %s, the limit %.4g", what, figure, unit,
                limit);
  std::string message(ToString(reason));
  message.append(line.data());
  return {reason, figure, limit, std::move(message)};
}

inline InitVerdict InvalidInput(const Status& status) {
  return {InitReason::kInvalidInput, 0.0, 0.0, status.message()};
}

}  // namespace glissade::internal
