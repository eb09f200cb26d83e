// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"

/// \file
/// The chi-square distribution, through the regularized incomplete gamma function P(dof / 2, x /
/// 2): its series below the mean, its continued fraction above, with the factor x^a e^-x / Gamma(a
/// + 1) in C. Loader's form ("Fast and accurate computation of binomial probabilities", 2000),
/// which loses no digits for many degrees of freedom. Relative error below 1e-12 for up to a
/// million of them (tested against tables of 30 digits).
namespace glissade::eval {

/// P(X <= x) for dof >= 1; 0 for x <= 0. NaN where dof < 1 or x is NaN.
[[nodiscard]] double ChiSquareCdf(double x, int dof);

/// P(X > x), with its digits where ChiSquareCdf has rounded to 1.
[[nodiscard]] double ChiSquareTail(double x, int dof);

/// The x with P(X <= x) = probability. kInvalidArgument unless dof >= 1 and 0 < probability < 1.
[[nodiscard]] Result<double> ChiSquareQuantile(double probability, int dof);

}  // namespace glissade::eval
