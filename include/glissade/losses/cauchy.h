// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/base/validate.h"

namespace glissade {

/// Cauchy's loss on the squared whitened residual s; `width` in sigmas:
/// rho(s) = width^2 log(1 + s / width^2) (as ceres::CauchyLoss).
struct Cauchy {
  double width = 1.0;

  void Evaluate(double s, double rho[3]) const {
    const double width2 = width * width;
    const double x = s / width2;
    const double weight = 1.0 / (1.0 + x);
    rho[0] = width2 * std::log1p(x);
    rho[1] = weight;
    rho[2] = -weight * weight / width2;
  }

  [[nodiscard]] Status Validate() const { return ValidatePositive(width, "Cauchy width"); }
};

}  // namespace glissade
