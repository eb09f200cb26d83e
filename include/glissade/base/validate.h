// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string_view>

#include "glissade/base/status.h"

/// \file
/// Checks at the border, shared by the Validate() of vertices, edges, losses and cameras. `what`
/// begins the message: "extrinsic: quaternion has norm 0.5, not 1". Good values are recognised
/// inline (a graph of a thousand edges is built in tens of microseconds); messages are made apart.
namespace glissade {

namespace internal {

inline bool AllFinite(const double* x, int n) {
  double sum = 0.0;
  for (int i = 0; i < n; ++i)
    sum += 0.0 * x[i];  // 0 for finite numbers, NaN for others
  return sum == 0.0;
}

Status NotFinite(const double* x, int n, std::string_view what);
Status NotPositive(double x, std::string_view what);
Status NotUnit(double norm, std::string_view what);

}  // namespace internal

/// kNotFinite when one of n numbers is NaN or infinite; names its index.
inline Status ValidateFinite(const double* x, int n, std::string_view what) {
  if (internal::AllFinite(x, n)) return {};
  return internal::NotFinite(x, n, what);
}

/// kNotFinite, or kNotPositive when x <= 0.
inline Status ValidatePositive(double x, std::string_view what) {
  if (!internal::AllFinite(&x, 1)) return internal::NotFinite(&x, 1, what);
  if (x <= 0.0) return internal::NotPositive(x, what);
  return {};
}

/// q = x y z w: finite, and of unit length within 1e-6 (else kInvalidArgument).
inline Status ValidateQuaternion(const double* q, std::string_view what) {
  if (!internal::AllFinite(q, 4)) return internal::NotFinite(q, 4, what);
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(norm - 1.0) <= 1e-6)) return internal::NotUnit(norm, what);
  return {};
}

/// px py pz qx qy qz qw: finite, and a unit quaternion within 1e-6 (else kInvalidArgument).
inline Status ValidatePose(const double* pose, std::string_view what) {
  if (!internal::AllFinite(pose, 7)) return internal::NotFinite(pose, 7, what);
  return ValidateQuaternion(pose + 3, what);
}

}  // namespace glissade
