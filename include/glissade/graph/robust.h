// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "glissade/losses/loss.h"

namespace glissade::internal {

/// Second-order correction of a robustified residual (Triggs, Bundle Adjustment - A Modern
/// Synthesis, Eqs. 9-12, as in Ceres): with r and J replaced by
///     r~ = residual_scale * r,   J~ = jacobian_scale * (J - alpha_over_s * r (r' J))
/// J~'r~ is the gradient of rho(s)/2 and J~'J~ its Hessian without the terms in r''. The
/// second-order term is used where rho'' > 0 only.
struct RobustScale {
  double cost = 0.0;  ///< rho(s) / 2
  double residual_scale = 1.0;
  double jacobian_scale = 1.0;
  double alpha_over_s = 0.0;

  RobustScale(const Loss& loss, double s) {
    double rho[3];
    loss.Evaluate(s, rho);
    cost = 0.5 * rho[0];
    const double root = std::sqrt(rho[1]);
    residual_scale = jacobian_scale = root;
    if (s == 0.0 || rho[2] <= 0.0) return;
    const double discriminant = 1.0 + 2.0 * s * rho[2] / rho[1];
    const double alpha = 1.0 - std::sqrt(discriminant > 0.0 ? discriminant : 0.0);
    // alpha = 1 would make the residual scale infinite; rho'' > 0 keeps alpha <= 0.
    residual_scale = root / (1.0 - alpha);
    alpha_over_s = alpha / s;
  }
};

/// J (rows x cols, row-major) <- the corrected Jacobian; r is not yet scaled.
inline void CorrectJacobian(const RobustScale& scale, int rows, int cols, const double* r,
                            double* J) {
  for (int c = 0; c < cols; ++c) {
    double projection = 0.0;
    if (scale.alpha_over_s != 0.0) {
      for (int k = 0; k < rows; ++k)
        projection += r[k] * J[k * cols + c];
    }
    for (int k = 0; k < rows; ++k) {
      double& x = J[k * cols + c];
      x = scale.jacobian_scale * (x - scale.alpha_over_s * projection * r[k]);
    }
  }
}

}  // namespace glissade::internal
