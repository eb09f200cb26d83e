// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Data of the kernels for points in the world, seen by edges that know pose and point by the
// relative position alone. Lanes are points.
//
// With f = d r / dX of a row of the residual and X relative to o (kernels/twists.h), a change of
// both by the same twist changes nothing, so that d r / d xi = -[f; X x f]. What a pose sees of a
// point is then, whatever the edges, in nine numbers:
//     F = sum f f',   g = -sum r f
// are what it adds to H_ll and b_l of the point; W = -[F; X x F]; and H and b of the pose have
//     [F, (X x F)'; X x F, X x (X x F)'],   -[g; X x g].

#ifndef GLISSADE_KERNELS_POINTS_H_
#define GLISSADE_KERNELS_POINTS_H_

#include <stdint.h>

#include "kernels/two_view.h"

namespace glissade::kernels {

/// Where a run of edges, lanes of one pose, adds to: arrays of `stride` numbers.
struct PointTotals {
  double* F;  ///< six arrays: the lower triangle by rows
  double* g;  ///< three
  int64_t stride;
  bool sets;           ///< F and g are set, not added to
  const double* turn;  ///< to the axes that F is wanted in, row-major; null: they are those
};

/// Observations by an ideal camera: with its pose (R, c), R' (X - c) = z (u, v, 1) and the residual
/// (u, v) - uv. In the camera's axes, rows of f are (1, 0, -u) / z and (0, 1, -v) / z.
struct PointViewRun {
  int32_t lanes;     ///< multiple of kLaneBlock
  const double* uv;  ///< two arrays of `lanes`
  const double* X;   ///< three arrays of x_stride: relative to what the camera's c is
  int64_t x_stride;
  const double* mask;  ///< null, or 0 where a lane does not count and its point is not looked at
  const TwoViewCamera* camera;
};

/// What a pose sees of the points of a group, after its runs, and where it adds it.
struct PointFrame {
  int32_t lanes;    ///< multiple of kLaneBlock
  const double* F;  ///< six arrays of `lanes`
  const double* g;  ///< three
  const double* X;  ///< three arrays of `stride`, relative to o
  double* h;        ///< H_ll: six arrays of `stride`, added to
  double* b;        ///< b_l: three
  int64_t stride;
  double* sums;  ///< as those of TwistTotals
};

}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_POINTS_H_
