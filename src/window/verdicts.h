// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>

#include "glissade/window/init_verdict.h"

namespace glissade::internal {

/// Whether a verdict says why for people too: a string, and so an allocation. Who asks at every
/// frame goes without.
enum class Words : std::uint8_t { kYes, kNone };

/// "what: figure unit, limit limit unit".
inline InitVerdict Refusal(InitReason reason, double figure, double limit, const char* what,
                           const char* unit, Words words = Words::kYes) {
  if (words == Words::kNone) return {reason, figure, limit, {}};
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
