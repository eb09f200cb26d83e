// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/testing/numeric_derivative.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glissade {

namespace {

constexpr int kLevels = 20;  // steps tried
constexpr int kOrders = 8;   // of extrapolation; higher ones only amplify rounding

/// One row's tableau: central differences and their extrapolations at the last step and this one.
struct Tableau {
  double previous[kOrders + 1] = {};
  double current[kOrders + 1] = {};

  /// Adds the difference (plus - minus) / (2 step) after `columns` usable ones.
  void Add(double plus, double minus, double step, int columns, double& value, double& best_error) {
    std::copy_n(current, kOrders + 1, previous);
    current[0] = (plus - minus) / (2.0 * step);
    // Two neighbours may agree by chance where rounding already rules: hence its floor.
    const double rounding = 2e-16 * (std::abs(plus) + std::abs(minus)) / step;
    double power = 1.0;
    for (int k = 1; k <= columns; ++k) {
      power *= 4.0;
      current[k] = current[k - 1] + (current[k - 1] - previous[k - 1]) / (power - 1.0);
      const double error = std::max({rounding, std::abs(current[k] - current[k - 1]),
                                     std::abs(current[k] - previous[k - 1])});
      if (error < best_error) {
        best_error = error;
        value = current[k];
      }
    }
  }
};

}  // namespace

NumericDerivative Differentiate(const std::function<bool(double, double*)>& f, int rows,
                                double initial_step) {
  const auto n = static_cast<std::size_t>(rows);
  NumericDerivative best;
  best.value.assign(n, 0.0);
  best.error.assign(n, std::numeric_limits<double>::infinity());
  std::vector<Tableau> tableaus(n);
  std::vector<double> plus(n), minus(n);
  int columns = 0;
  double step = initial_step;
  for (int level = 0; level < kLevels; ++level, step *= 0.5) {
    if (!f(step, plus.data()) || !f(-step, minus.data())) {
      columns = 0;
      continue;
    }
    for (std::size_t i = 0; i < n; ++i) {
      tableaus[i].Add(plus[i], minus[i], step, columns, best.value[i], best.error[i]);
    }
    columns = std::min(columns + 1, kOrders);
  }
  return best;
}

}  // namespace glissade
