// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/validate.h"

#include <cmath>
#include <cstdio>
#include <string>

namespace glissade {

namespace {

std::string Message(std::string_view what, std::string_view problem) {
  std::string message(what);
  message += ": ";
  message += problem;
  return message;
}

std::string ToText(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof(buffer), "%.9g", x);
  return buffer;
}

constexpr double kUnitTolerance = 1e-6;

}  // namespace

Status ValidateFinite(const double* x, int n, std::string_view what) {
  for (int i = 0; i < n; ++i) {
    if (std::isfinite(x[i])) continue;
    std::string problem = "value ";
    if (n > 1) problem += std::to_string(i) + " ";
    return {StatusCode::kNotFinite, Message(what, problem + "is " + ToText(x[i]))};
  }
  return {};
}

Status ValidatePositive(double x, std::string_view what) {
  if (!std::isfinite(x)) return {StatusCode::kNotFinite, Message(what, "value is " + ToText(x))};
  if (x <= 0.0) {
    return {StatusCode::kNotPositive, Message(what, "value is " + ToText(x) + ", not positive")};
  }
  return {};
}

Status ValidatePose(const double* pose, std::string_view what) {
  if (Status status = ValidateFinite(pose, 7, what); !status.ok()) return status;
  const double* q = pose + 3;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(norm - 1.0) <= kUnitTolerance)) {
    return {StatusCode::kInvalidArgument,
            Message(what, "quaternion has norm " + ToText(norm) + ", not 1")};
  }
  return {};
}

}  // namespace glissade
