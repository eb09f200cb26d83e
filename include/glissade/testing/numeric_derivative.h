// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

namespace glissade {

/// A numeric derivative and an estimate of its error (infinite where there is none), row by row.
struct NumericDerivative {
  std::vector<double> value;
  std::vector<double> error;
};

/// d f(t) / d t at t = 0 by central differences with steps initial_step / 2^k, extrapolated to step
/// zero (C. Ridders, "Accurate computation of F'(x) and F'(x)F''(x)", 1982). A plain difference at
/// one step leaves 1e-9 to 1e-5 of truncation and rounding; this leaves 1e-13 to 1e-10 and says
/// which. `f(t, y)` writes `rows` numbers and returns false where it has no value or one that is
/// not finite; such steps are skipped.
NumericDerivative Differentiate(const std::function<bool(double t, double* y)>& f, int rows,
                                double initial_step);

}  // namespace glissade
