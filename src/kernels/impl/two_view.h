// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Reprojections between two cameras; see kernels/two_view.h.

#ifndef GLISSADE_KERNELS_IMPL_TWO_VIEW_H_
#define GLISSADE_KERNELS_IMPL_TWO_VIEW_H_

#include "kernels/impl/simd.h"
#include "kernels/two_view.h"

namespace glissade::kernels {
namespace {

/// out = row . (x, y, 1) + d rho.
GLISSADE_INLINE vd Affine(const double* row, double d, vd x, vd y, vd rho) {
  return Splat(row[0]) * x + (Splat(row[1]) * y + (Splat(d) * rho + Splat(row[2])));
}

void TwoViewLanes(const TwoViewRun* run) {
  // Host camera in the target's.
  double A[9], d[3];
  const double *R_t = run->target->R_wc, *R_h = run->host->R_wc;
  const double *c_t = run->target->c, *c_h = run->host->c;
  for (int i = 0; i < 3; ++i) {
    d[i] = 0.0;
    for (int k = 0; k < 3; ++k)
      d[i] += R_t[3 * k + i] * (c_h[k] - c_t[k]);
    for (int j = 0; j < 3; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k)
        sum += R_t[3 * k + i] * R_h[3 * k + j];
      A[3 * i + j] = sum;
    }
  }
  const Index n = run->lanes;
  for (Index s = 0; s < n; s += kW) {
    vd rho;
#pragma GCC unroll 8
    for (int i = 0; i < kW; ++i)
      rho[i] = run->depths[run->depth_of_lane[s + i]];
    const vd x = Load(run->uv + s), y = Load(run->uv + n + s);
    const vd qx = Affine(A, d[0], x, y, rho);
    const vd qy = Affine(A + 3, d[1], x, y, rho);
    const vd qz = Affine(A + 6, d[2], x, y, rho);
    const vd inverse_z = Splat(1.0) / qz;
    const vd u = qx * inverse_z, v = qy * inverse_z;
    Store(run->r + s, u - Load(run->uv + 2 * n + s));
    Store(run->r + n + s, v - Load(run->uv + 3 * n + s));
    if (run->J_l == nullptr) continue;
    // Rows of f: (1, 0, -u) / z and (0, 1, -v) / z.
    const vd fu = -(u * inverse_z), fv = -(v * inverse_z);
    Store(run->J_l + s, inverse_z * Splat(d[0]) + fu * Splat(d[2]));
    Store(run->J_l + n + s, inverse_z * Splat(d[1]) + fv * Splat(d[2]));
    if (run->compact) {
      const vd numbers[4] = {u, v, inverse_z, rho};
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k)
        Store(run->J + k * n + s, numbers[k]);
      continue;
    }
    // f x q, in units of z where it cancels: q / z = (u, v, 1).
    const vd one = Splat(1.0);
    const vd minus_rho = -rho;
    const vd rows[12] = {minus_rho * inverse_z, Zero(),      minus_rho * fu, u * v,
                         -(one + u * u),        v,           Zero(),         minus_rho * inverse_z,
                         minus_rho * fv,        one + v * v, -(u * v),       -u};
#pragma GCC unroll 12
    for (int k = 0; k < 12; ++k)
      Store(run->J + k * n + s, rows[k]);
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_TWO_VIEW_H_
