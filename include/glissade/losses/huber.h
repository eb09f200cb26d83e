// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/base/validate.h"

namespace glissade {

/// Huber's loss on the squared whitened residual s; `width` in sigmas:
/// rho(s) = s up to s = width^2, 2 width sqrt(s) - width^2 beyond (as ceres::HuberLoss).
struct Huber {
  double width = 1.0;

  void Evaluate(double s, double rho[3]) const {
    const double width2 = width * width;
    if (s > width2) {
      const double root = std::sqrt(s);
      rho[0] = 2.0 * width * root - width2;
      rho[1] = width / root;
      rho[2] = -rho[1] / (2.0 * s);
    } else {
      rho[0] = s;
      rho[1] = 1.0;
      rho[2] = 0.0;
    }
  }

  [[nodiscard]] Status Validate() const { return ValidatePositive(width, "Huber width"); }
};

}  // namespace glissade
