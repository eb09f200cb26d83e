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

/// x with P(chi2(dof) > x) = tail; of tails below 1e-15 that of 1e-15. Who asks for the same again,
/// as a window does at every frame, has it from the last time.
inline double Chi2Quantile(int dof, double tail) {
  struct Answer {
    int dof = 0;
    double tail = 0.0, quantile = 0.0;
  };
  thread_local Answer last;
  if (dof != last.dof || tail != last.tail) {
    last = {dof, tail, eval::ChiSquareQuantile(1.0 - std::max(tail, 1e-15), dof).value()};
  }
  return last.quantile;
}

}  // namespace glissade::internal
