// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/validate.h"

#include <cstdio>
#include <string>

namespace glissade::internal {

namespace {

std::string Message(std::string_view what, const std::string& problem) {
  return std::string(what) + ": " + problem;
}

std::string ToText(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof(buffer), "%.9g", x);
  return buffer;
}

}  // namespace

Status NotFinite(const double* x, int n, std::string_view what) {
  int culprit = 0;
  while (culprit < n - 1 && std::isfinite(x[culprit]))
    ++culprit;
  std::string problem = "value";
  if (n > 1) problem.append("[").append(std::to_string(culprit)).append("]");
  return {StatusCode::kNotFinite, Message(what, problem + " is " + ToText(x[culprit]))};
}

Status NotPositive(double x, std::string_view what) {
  return {StatusCode::kNotPositive, Message(what, "value is " + ToText(x) + ", not positive")};
}

Status NotUnit(double norm, std::string_view what) {
  return {StatusCode::kInvalidArgument,
          Message(what, "quaternion has norm " + ToText(norm) + ", not 1")};
}

}  // namespace glissade::internal
