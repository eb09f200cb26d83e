// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/validate.h"

namespace glissade {

/// Tukey's biweight on the squared whitened residual s; `width` in sigmas:
/// rho(s) = width^2 / 3 (1 - (1 - s / width^2)^3) up to s = width^2, constant beyond: farther
/// residuals have no influence at all (as ceres::TukeyLoss of Ceres 2).
struct Tukey {
  double width = 1.0;

  void Evaluate(double s, double rho[3]) const {
    const double width2 = width * width;
    if (s <= width2) {
      const double v = 1.0 - s / width2;
      rho[0] = width2 / 3.0 * (1.0 - v * v * v);
      rho[1] = v * v;
      rho[2] = -2.0 / width2 * v;
    } else {
      rho[0] = width2 / 3.0;
      rho[1] = 0.0;
      rho[2] = 0.0;
    }
  }

  [[nodiscard]] Status Validate() const { return ValidatePositive(width, "Tukey width"); }
};

}  // namespace glissade
