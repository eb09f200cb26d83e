// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Data of the fused reprojection kernels: all two-frame inverse-depth observations of the landmarks
// of one host camera, as structures of arrays. Lanes are landmarks.
//
// With camera poses (R_wc, c) of host h and target t, bearing b = (x, y, 1) and inverse depth rho,
//     Y = R_t' R_h b + rho R_t' (c_h - c_t),   residual = L (Y.xy / Y.z - uv),
// which has a value at rho = 0 too. Poses are linearized as twists about a point o common to all
// frames, xi = (v, w): dX = v + w x (X - o). Then d r / d xi_host = [f; q] with f = dr/dP the
// derivative with respect to the world point P and q = (P - o) x f, and d r / d xi_target = -[f;
// q]: one 6-vector per residual row serves both frames.

#ifndef GLISSADE_KERNELS_REPROJECTION_H_
#define GLISSADE_KERNELS_REPROJECTION_H_

#include <stdint.h>

namespace glissade::kernels {

/// Arrays of lanes come in blocks of this many, whatever the instruction set.
constexpr int kLaneBlock = 8;

/// Observations of one target camera.
struct ReprojectionTarget {
  int32_t lanes;    ///< multiple of kLaneBlock: the landmarks beyond are not observed here
  const double* u;  ///< measured image point, per lane
  const double* v;
  const double* mask;  ///< 1: observed, 0: not (then nothing else of the lane counts)
  const double*
      sqrt_information;  ///< null: the host's; else four arrays of `lanes`: L00 L01 L10 L11
  const double* huber;   ///< null: no robust loss; else the width per lane (infinite: none)
  double* force;         ///< out: three arrays of `lanes`: F = sum_k j_k f_k, j = dr/drho

  double A[9];     ///< R_t' R_h, row-major
  double d[3];     ///< R_t' (c_h - c_t)
  double R_cw[9];  ///< R_t', row-major

  double H[36];  ///< out: sum of [f; q][f; q]', row-major, full
  double g[6];   ///< out: sum of r [f; q]
};

/// Landmarks of one host camera and what observes them.
struct ReprojectionHost {
  int32_t lanes;  ///< multiple of kLaneBlock
  int32_t num_targets;
  ReprojectionTarget* targets;
  const double* x;  ///< bearing (x, y, 1), per lane
  const double* y;
  const double* rho;  ///< inverse depth, per lane
  double L[4];        ///< square-root information of targets without their own, row-major

  double R_wc[9];  ///< host camera, row-major
  double c[3];     ///< its centre minus o

  double* h;      ///< out: H_ll, per lane
  double* b;      ///< out: b_l = -j'r, per lane
  double* point;  ///< out: three arrays of `lanes`: P - o
  double cost;    ///< out: sum of rho(s) / 2
};

}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_REPROJECTION_H_
