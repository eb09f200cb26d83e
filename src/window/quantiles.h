// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace glissade::internal {

/// z with P(N(0, 1) > z) = tail, 0 < tail < 1/2, to 5e-4: Abramowitz and Stegun, 26.2.23.
inline double NormalQuantile(double tail) {
  const double t = std::sqrt(-2.0 * std::log(tail));
  return t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                 (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
}

/// x with P(chi2(dof) > x) = tail: Wilson and Hilferty (1931), within 1 % of x from 3 degrees on.
inline double Chi2Quantile(int dof, double tail) {
  const double k = 2.0 / (9.0 * dof);
  const double cube_root = 1.0 - k + NormalQuantile(tail) * std::sqrt(k);
  return dof * cube_root * cube_root * cube_root;
}

}  // namespace glissade::internal
