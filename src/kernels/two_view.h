// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Data of the kernel that evaluates reprojections of inverse depths between two ideal cameras.
//
// With camera poses (R, c) of host h and target t in the world, bearing b = (x, y, 1) and inverse
// depth rho,
//     q = R_t' R_h b + rho R_t' (c_h - c_t) = z (u, v, 1),   residual = (u, v) - uv,
// which has a value at rho = 0 too. Its derivative by a motion of the target camera is given in
// that camera's axes: with f = d residual / d q, by [position, rotation] it is [-rho f, f x q].

#ifndef GLISSADE_KERNELS_TWO_VIEW_H_
#define GLISSADE_KERNELS_TWO_VIEW_H_

#include <stdint.h>

namespace glissade::kernels {

struct TwoViewCamera {
  double R_wc[9];  ///< row-major
  double c[3];     ///< relative to a point that is the same for both
};

struct TwoViewRun {
  int32_t lanes;         ///< multiple of kLaneBlock
  const double* uv;      ///< four arrays of `lanes`: host's x, y, target's u, v
  const double* depths;  ///< inverse depth of lane s: depths[depth_of_lane[s]]
  const int32_t* depth_of_lane;
  const TwoViewCamera* host;
  const TwoViewCamera* target;
  double* r;    ///< out: 2 x 1, as all in lanes (kernels.h)
  double* J_l;  ///< out: by rho, 2 x 1; null: not wanted, and neither is J
  double* J;    ///< out: 2 x 6, by the target camera; where `compact`, u, v, 1/z and rho instead
  bool compact;
};

}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_TWO_VIEW_H_
