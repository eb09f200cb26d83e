// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/status.h"

namespace glissade {

std::string_view ToString(StatusCode code) {
  switch (code) {
    case StatusCode::kOk:
      return "ok";
    case StatusCode::kInvalidArgument:
      return "invalid argument";
    case StatusCode::kUnknownHandle:
      return "unknown handle";
    case StatusCode::kNotFinite:
      return "not finite";
    case StatusCode::kNotPositive:
      return "not positive";
    case StatusCode::kDuplicate:
      return "duplicate";
    case StatusCode::kEliminatedPair:
      return "edge between eliminated vertices";
    case StatusCode::kRepeatedVertex:
      return "repeated vertex";
    case StatusCode::kUnderPrior:
      return "under a marginal prior";
    case StatusCode::kNothingToSolve:
      return "nothing to solve";
    case StatusCode::kSingular:
      return "singular";
    case StatusCode::kEvaluationFailed:
      return "evaluation failed";
    case StatusCode::kIoError:
      return "i/o error";
    case StatusCode::kParseError:
      return "parse error";
    case StatusCode::kOutOfMemory:
      return "out of memory";
  }
  return "unknown";
}

}  // namespace glissade
