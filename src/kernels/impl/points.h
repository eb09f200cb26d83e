// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Points in the world: sums over their edges; see kernels/points.h.

#ifndef GLISSADE_KERNELS_IMPL_POINTS_H_
#define GLISSADE_KERNELS_IMPL_POINTS_H_

#include "kernels/impl/twists.h"
#include "kernels/points.h"

namespace glissade::kernels {
namespace {

/// Where (i, j) of a symmetric 3 x 3 is, that is given by its lower triangle.
constexpr int Lower(int i, int j) {
  return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
}

template <int kCount>
GLISSADE_INLINE void LoadArrays(const double* from, Index stride, vd (&x)[kCount]) {
#pragma GCC unroll 6
  for (int i = 0; i < kCount; ++i)
    x[i] = Load(from + i * stride);
}
template <int kCount>
GLISSADE_INLINE void StoreArrays(const vd (&x)[kCount], bool sets, Index stride, double* to) {
#pragma GCC unroll 6
  for (int i = 0; i < kCount; ++i)
    Store(to + i * stride, sets ? x[i] : Load(to + i * stride) + x[i]);
}

GLISSADE_INLINE void CrossOf(const vd (&a)[3], const vd (&b)[3], vd (&out)[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/// F += f f'.
GLISSADE_INLINE void AddSquare(const vd (&f)[3], vd (&F)[6]) {
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
#pragma GCC unroll 3
    for (int j = 0; j <= i; ++j)
      F[Lower(i, j)] += f[i] * f[j];
  }
}

int PointSums(const TwistRun* run, const PointTotals* to) {
  const Index lanes = run->lanes;
  vd poison = Zero();
#pragma GCC unroll 1
  for (Index s = 0; s < lanes; s += kW) {
    const vd weight = run->weight != nullptr ? Load(run->weight + s) : Splat(1.0);
    const vd factor = weight * Splat(run->scale);
    vd F[6] = {Zero(), Zero(), Zero(), Zero(), Zero(), Zero()};
    vd g[3] = {Zero(), Zero(), Zero()};
#pragma GCC unroll 1
    for (int k = 0; k < run->rows; ++k) {
      const vd r = weight * Load(run->r + k * lanes + s);
      vd at_x[3], f[3];
      LoadArrays(run->J_l + 3 * k * lanes + s, lanes, at_x);
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        f[i] = at_x[i] = factor * at_x[i];
      if (to->turn != nullptr) Rotate(to->turn, at_x, f);
      AddSquare(f, F);
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        g[i] -= r * f[i];
    }
    poison += Zero() * ((F[0] + F[2] + F[5]) + (g[0] + g[1] + g[2]));
    StoreArrays(F, to->sets, to->stride, to->F + s);
    StoreArrays(g, to->sets, to->stride, to->g + s);
  }
  return Sum(poison) == 0.0 ? 1 : 0;
}

/// M = X x F, column by column.
GLISSADE_INLINE void MomentOf(const vd (&X)[3], const vd (&F)[6], vd (&M)[3][3]) {
#pragma GCC unroll 3
  for (int j = 0; j < 3; ++j) {
    const vd column[3] = {F[Lower(0, j)], F[Lower(1, j)], F[Lower(2, j)]};
    vd moment[3];
    CrossOf(X, column, moment);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      M[i][j] = moment[i];
  }
}

int PointFrameSums(const PointFrame* frame) {
  vd sum[kUsedTwistSums];
#pragma GCC unroll 32
  for (int i = 0; i < kUsedTwistSums; ++i)
    sum[i] = Zero();
#pragma GCC unroll 1
  for (Index s = 0; s < frame->lanes; s += kW) {
    vd F[6], g[3], X[3], M[3][3], Xg[3];
    LoadArrays(frame->F + s, frame->lanes, F);
    LoadArrays(frame->g + s, frame->lanes, g);
    LoadArrays(frame->X + s, frame->stride, X);
    StoreArrays(F, false, frame->stride, frame->h + s);
    StoreArrays(g, false, frame->stride, frame->b + s);
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i)
      sum[i] += F[i];
    CrossOf(X, g, Xg);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      sum[21 + i] -= g[i];
      sum[24 + i] -= Xg[i];
    }
    MomentOf(X, F, M);
    int term = 6;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
#pragma GCC unroll 3
      for (int j = 0; j < 3; ++j, ++term)
        sum[term] += M[i][j];
      // Row i of X x (X x F)'.
      vd Q[3];
      CrossOf(X, M[i], Q);
#pragma GCC unroll 3
      for (int j = 0; j <= i; ++j, ++term)
        sum[term] += Q[j];
    }
  }
  vd poison = Zero();
#pragma GCC unroll 16
  for (int i = 0; i < kUsedTwistSums; i += kW) {
    const vd total = SumEach(sum + i);
    poison += Zero() * total;
    Store(frame->sums + i, Load(frame->sums + i) + total);
  }
  return Sum(poison) == 0.0 ? 1 : 0;
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_POINTS_H_
