// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "glissade/eval/chi_square.h"

namespace glissade::internal {

/// z with P(N(0, 1) > z) = tail, 0 < tail < 1/2, to 5e-4: Abramowitz and Stegun, 26.2.23.
inline double NormalQuantile(double tail) {
  const double t = std::sqrt(-2.0 * std::log(tail));
  return t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                 (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
}

/// x with P(chi2(dof) > x) = tail; of tails below 1e-15 that of 1e-15.
inline double Chi2Quantile(int dof, double tail) {
  return eval::ChiSquareQuantile(1.0 - std::max(tail, 1e-15), dof).value();
}

}  // namespace glissade::internal
