// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Data of the kernels for reprojections of inverse depths between two ideal cameras.
//
// With camera poses (R, c) of host h and target t in the world, bearing b = (x, y, 1) and inverse
// depth rho,
//     q = R_t' R_h b + rho R_t' (c_h - c_t) = z (u, v, 1),   residual = (u, v) - uv,
// which has a value at rho = 0 too. Its derivative by a motion of the target camera is given in
// that camera's axes: with f = d residual / d q, by [position, rotation] it is [-rho f, f x q].

#ifndef GLISSADE_KERNELS_TWO_VIEW_H_
#define GLISSADE_KERNELS_TWO_VIEW_H_

#include <stdint.h>

#include "kernels/losses.h"

namespace glissade::kernels {

struct TwoViewCamera {
  double R_wc[9];  ///< row-major
  double c[3];     ///< relative to a point that is the same for both
};

/// Arrays of `lanes`, a multiple of kLaneBlock.
struct TwoViewRun {
  int32_t lanes;
  const double* uv;     ///< four arrays: host's x, y, target's u, v
  const double* depth;  ///< inverse depths
  const double* mask;   ///< null, or 0 where a lane does not count and its depth is not looked at
  const TwoViewCamera* host;
  const TwoViewCamera* target;
};

/// What multiplies residuals that are not whitened but by a factor for each row.
struct TwoViewWeights {
  double scale[2];  ///< of the residual's rows; of inverse depths scale[0] is not 0
  LaneLoss loss;
  const double* width;  ///< of the loss per lane (infinite: none)
};

/// As all in lanes (kernels.h).
struct TwoViewValues {
  double* r;    ///< 2 x 1
  double* J_l;  ///< by rho, 2 x 1; null: not wanted, and neither is J
  double* J;    ///< 2 x 6, by the target camera
};

}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_TWO_VIEW_H_
