// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/io/bal.h"

namespace glissade::bench {

/// 1/2 sum |r|^2 of a solution (px^2), from the BAL format's definition with nothing of the
/// library's own edges and rotations: P = R(w) X + t, p = -P / P_z, r = f (1 + k1 |p|^2 + k2 |p|^4)
/// p - (u, v). The numbers are doubles; the sum, which may be of 20 million terms, is a long
/// double.
inline double AuditedCost(const BalProblem& solution,
                          const std::vector<BalObservation>& observations) {
  long double sum = 0.0L;
  for (const BalObservation& seen : observations) {
    const double* const c = solution.cameras[static_cast<std::size_t>(seen.camera)].data;
    const double* const X = solution.points[static_cast<std::size_t>(seen.point)].data;
    // Rodrigues: R X = cos X + sin (a x X) + (1 - cos) (a . X) a, a the axis.
    const double angle = std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
    double P[3];
    const double cross[3] = {c[1] * X[2] - c[2] * X[1], c[2] * X[0] - c[0] * X[2],
                             c[0] * X[1] - c[1] * X[0]};
    if (angle > 1e-12) {
      const double cosine = std::cos(angle), sine = std::sin(angle);
      const double along =
          (1.0 - cosine) * (c[0] * X[0] + c[1] * X[1] + c[2] * X[2]) / (angle * angle);
      for (int k = 0; k < 3; ++k) {
        P[k] = cosine * X[k] + sine / angle * cross[k] + along * c[k] + c[3 + k];
      }
    } else {
      for (int k = 0; k < 3; ++k)
        P[k] = X[k] + cross[k] + c[3 + k];
    }
    const double x = -P[0] / P[2], y = -P[1] / P[2];
    const double n = x * x + y * y;
    const double scale = c[6] * (1.0 + n * (c[7] + n * c[8]));
    const double rx = scale * x - seen.u, ry = scale * y - seen.v;
    sum += static_cast<long double>(rx * rx + ry * ry);
  }
  return static_cast<double>(0.5L * sum);
}

}  // namespace glissade::bench
