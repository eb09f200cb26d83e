// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "glissade/base/matrix.h"

namespace glissade::internal {

/// A numeric derivative and an estimate of its error, row by row.
template <int Rows>
struct NumericDerivative {
  Vector<Rows> value = Vector<Rows>::Zero();
  Vector<Rows> error = Vector<Rows>::Constant(std::numeric_limits<double>::infinity());
};

/// d f(t) / d t at t = 0 by central differences with steps initial_step / 2^k, extrapolated to step
/// zero (C. Ridders, "Accurate computation of F'(x) and F'(x)F''(x)", 1982). A plain difference at
/// one step leaves 1e-9 to 1e-5 of truncation and rounding; this leaves 1e-13 to 1e-9 and says
/// which. `f(t, y)` returns false where it has no value; such steps are skipped.
template <int Rows, class F>
NumericDerivative<Rows> Differentiate(const F& f, double initial_step) {
  constexpr int kLevels = 20;
  NumericDerivative<Rows> best;
  std::array<Vector<Rows>, kLevels> previous;
  int columns = 0;  // valid entries of `previous`
  double step = initial_step;
  for (int level = 0; level < kLevels; ++level, step *= 0.5) {
    std::array<Vector<Rows>, kLevels> current;
    Vector<Rows> plus, minus;
    if (!f(step, plus) || !f(-step, minus)) {
      columns = 0;
      continue;
    }
    current[0] = (plus - minus) / (2.0 * step);
    double power = 1.0;
    for (int k = 1; k <= columns; ++k) {
      power *= 4.0;
      current[k] = current[k - 1] + (current[k - 1] - previous[k - 1]) / (power - 1.0);
      for (int row = 0; row < Rows; ++row) {
        // Two neighbours may agree by chance where rounding already rules: hence its floor.
        const double rounding = 2e-16 * (std::abs(plus[row]) + std::abs(minus[row])) / step;
        const double error =
            std::fmax(rounding, std::fmax(std::abs(current[k][row] - current[k - 1][row]),
                                          std::abs(current[k][row] - previous[k - 1][row])));
        if (error < best.error[row]) {
          best.error[row] = error;
          best.value[row] = current[k][row];
        }
      }
    }
    columns = columns < 8 ? columns + 1 : 8;  // higher orders only amplify rounding
    previous = current;
  }
  return best;
}

}  // namespace glissade::internal
