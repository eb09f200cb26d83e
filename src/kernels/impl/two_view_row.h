// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The second row of reprojections between two cameras by itself, where it weighs more or less than
// the first: see kernels/impl/two_view_sums.h, whose sums give both rows one weight.

#ifndef GLISSADE_KERNELS_IMPL_TWO_VIEW_ROW_H_
#define GLISSADE_KERNELS_IMPL_TWO_VIEW_ROW_H_

#include "kernels/impl/simd.h"
#include "kernels/twists.h"

namespace glissade::kernels {
namespace {

/// What the second pass takes of the first, for so many lanes at a time.
struct TwoViewScratch {
  static constexpr int kLanes = 64;
  alignas(64) double u[kLanes], v[kLanes], g[kLanes], w[kLanes], r0[kLanes], r1[kLanes];
};

/// Of the row of v alone, whose numbers but for the zero are e = [g, -g v, -(1 + v^2), u v, u]:
/// sum e e', lower triangle by rows, and sum r1 e.
constexpr int kRowSums = 20;
constexpr int kRowVectors = (kRowSums + kW - 1) / kW * kW;

GLISSADE_INLINE void AddRowSums(const TwoViewScratch& from, Index lanes, vd (&sum)[kRowVectors]) {
#pragma GCC unroll 1
  for (Index s = 0; s < lanes; s += kW) {
    const vd u = Load(from.u + s), v = Load(from.v + s), g = Load(from.g + s);
    const vd e[5] = {g, -(g * v), -(Splat(1.0) + v * v), u * v, u};
    const vd w = Load(from.w + s), wr = w * Load(from.r1 + s);
#pragma GCC unroll 5
    for (int i = 0; i < 5; ++i) {
      const vd we = w * e[i];
#pragma GCC unroll 5
      for (int j = 0; j <= i; ++j)
        sum[i * (i + 1) / 2 + j] += we * e[j];
      sum[15 + i] += wr * e[i];
    }
  }
}

/// R A R' of a 3 x 3.
GLISSADE_INLINE void TurnBoth(const double* R, const double (&A)[3][3], double (&out)[3][3]) {
  for (int i = 0; i < 3; ++i) {
    double row[3];
    for (int k = 0; k < 3; ++k)
      row[k] = R[3 * i] * A[0][k] + R[3 * i + 1] * A[1][k] + R[3 * i + 2] * A[2][k];
    for (int j = 0; j < 3; ++j)
      out[i][j] = row[0] * R[3 * j] + row[1] * R[3 * j + 1] + row[2] * R[3 * j + 2];
  }
}
/// p x each column.
GLISSADE_INLINE void CrossColumns(const double* p, const double (&A)[3][3], double (&out)[3][3]) {
  for (int j = 0; j < 3; ++j) {
    out[0][j] = p[1] * A[2][j] - p[2] * A[1][j];
    out[1][j] = p[2] * A[0][j] - p[0] * A[2][j];
    out[2][j] = p[0] * A[1][j] - p[1] * A[0][j];
  }
}

/// Adds `factor` times the sums of that row to those of the common frame, as TurnSums() does.
void TurnRowSums(const TwistFrame& frame, const double* x, double factor, double* sums) {
  // Of [f; q] = [0, e].
  double A[6][6];
  for (int i = 0; i < 6; ++i)
    A[0][i] = A[i][0] = 0.0;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j <= i; ++j)
      A[i + 1][j + 1] = A[j + 1][i + 1] = factor * x[i * (i + 1) / 2 + j];
  }
  double F[3][3], M[3][3], Q[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      F[i][j] = A[i][j];
      M[i][j] = A[3 + i][j];  // sum q f'
      Q[i][j] = A[3 + i][3 + j];
    }
  }
  double RF[3][3], RM[3][3], RQ[3][3], PF[3][3], PM[3][3], PFP[3][3];
  TurnBoth(frame.R, F, RF);
  TurnBoth(frame.R, M, RM);
  TurnBoth(frame.R, Q, RQ);
  // q becomes q + p x f: sum q f' = RM + P RF, sum q q' = RQ + P RM' + (P RM')' + P RF P'.
  CrossColumns(frame.p, RF, PF);
  double transposed[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      transposed[i][j] = RM[j][i];
  }
  CrossColumns(frame.p, transposed, PM);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      transposed[i][j] = PF[j][i];
  }
  CrossColumns(frame.p, transposed, PFP);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j)
      *sums++ += RF[i][j];
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      *sums++ += RM[i][j] + PF[i][j];
    for (int j = 0; j <= i; ++j)
      *sums++ += RQ[i][j] + (PM[i][j] + PM[j][i]) + PFP[i][j];
  }
  const double r[6] = {0.0, x[15], x[16], x[17], x[18], x[19]};
  double f[3], q[3];
  for (int i = 0; i < 3; ++i) {
    const double* R = frame.R + 3 * i;
    f[i] = factor * (R[0] * r[0] + R[1] * r[1] + R[2] * r[2]);
    q[i] = factor * (R[0] * r[3] + R[1] * r[4] + R[2] * r[5]);
  }
  const double* p = frame.p;
  const double m[3] = {p[1] * f[2] - p[2] * f[1], p[2] * f[0] - p[0] * f[2],
                       p[0] * f[1] - p[1] * f[0]};
  for (int i = 0; i < 3; ++i) {
    sums[i] += f[i];
    sums[3 + i] += q[i] + m[i];
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_TWO_VIEW_ROW_H_
