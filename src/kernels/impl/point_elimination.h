// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The elimination of points in the world; see kernels/points.h.

#ifndef GLISSADE_KERNELS_IMPL_POINT_ELIMINATION_H_
#define GLISSADE_KERNELS_IMPL_POINT_ELIMINATION_H_

#include "kernels/impl/points.h"

namespace glissade::kernels {
namespace {

/// H_ll + damping = L D L', C = D^-1/2 L^-1. Lanes that have no factor get zeros, and `good` unset.
GLISSADE_INLINE void PointFactor(const vd (&h)[6], vd lambda, vd low, vd high, vd (&C)[6],
                                 vi& good) {
  vd d[3];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const vd x = h[Lower(i, i)];
    vd clamped = x < low ? low : x;
    clamped = clamped > high ? high : clamped;
    d[i] = x + lambda * clamped;
  }
  const vd one = Splat(1.0), infinity = Splat(__builtin_inf());
  vd inverse[3];
  const auto invert = [&](int i) __attribute__((always_inline)) {
    const vi ok = (d[i] > Zero()) & (d[i] < infinity);
    good &= ok;
    inverse[i] = one / (ok ? d[i] : one);
  };
  good = ~vi{};
  invert(0);
  const vd l10 = h[Lower(1, 0)] * inverse[0], l20 = h[Lower(2, 0)] * inverse[0];
  d[1] -= l10 * h[Lower(1, 0)];
  const vd u21 = h[Lower(2, 1)] - l20 * h[Lower(1, 0)];
  invert(1);
  const vd l21 = u21 * inverse[1];
  d[2] -= l20 * h[Lower(2, 0)] + l21 * u21;
  invert(2);
  const vd root[3] = {Sqrt(inverse[0]), Sqrt(inverse[1]), Sqrt(inverse[2])};
  C[Lower(0, 0)] = root[0];
  C[Lower(1, 0)] = -(l10 * root[1]);
  C[Lower(1, 1)] = root[1];
  C[Lower(2, 0)] = (l21 * l10 - l20) * root[2];
  C[Lower(2, 1)] = -(l21 * root[2]);
  C[Lower(2, 2)] = root[2];
  // The inverse has their squares.
  vd squares = Zero();
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i)
    squares += C[i] * C[i];
  good &= squares < infinity;
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i)
    C[i] = good ? C[i] : Zero();
}

/// C x.
GLISSADE_INLINE void TimesFactor(const vd (&C)[6], const vd (&x)[3], vd (&out)[3]) {
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    out[i] = C[Lower(i, 0)] * x[0];
#pragma GCC unroll 3
    for (int j = 1; j <= i; ++j)
      out[i] += C[Lower(i, j)] * x[j];
  }
}

int PointPivots(const TwistGroup& group, const double* h, const double* b, double lambda,
                double min_diagonal, double max_diagonal, double* factor, double* beta) {
  const Index stride = group.lanes;
  int first_bad = -1;
  for (int lane = 0; lane < group.used; lane += kW) {
    vd H[6], C[6], bl[3], Cb[3];
    vi good;
    LoadArrays(h + lane, stride, H);
    LoadArrays(b + lane, stride, bl);
    PointFactor(H, Splat(lambda), Splat(min_diagonal), Splat(max_diagonal), C, good);
    for (int i = 0; i < kW && first_bad < 0; ++i) {
      if (lane + i < group.used && good[i] == 0) first_bad = lane + i;
    }
    TimesFactor(C, bl, Cb);
    StoreArrays(C, true, stride, factor + lane);
    StoreArrays(Cb, true, stride, beta + lane);
  }
  return first_bad;
}

/// Three columns of W C' per lane, that of lane s and k at 3 s + k.
void PointPanel(const TwistGroup& group, const double* factor, const double* beta, double* W) {
  const int n = TwistRows(group);
  const Index ld = (n + kPanelRows - 1) / kPanelRows * kPanelRows, stride = group.lanes;
  int seen = group.num_targets;
  for (int lane = 0; lane < group.used; lane += kW) {
    double* const columns = W + 3 * lane * ld;
    vd C[6], X[3], Cb[3];
    LoadArrays(factor + lane, stride, C);
    LoadArrays(group.X + lane, stride, X);
    LoadArrays(beta + lane, stride, Cb);
    while (seen > 0 && lane >= group.targets[seen - 1].lanes)
      --seen;
    // The block that the rows of these targets end in is zero beyond them.
    const int last = (1 + 6 * seen) / kPanelRows * kPanelRows;
    for (int i = 0; i < 3 * kW && last < ld; ++i) {
#pragma GCC unroll 4
      for (int zero = 0; zero < kPanelRows; zero += kW)
        Store(columns + i * ld + last + zero, Zero());
    }
#pragma GCC unroll 8
    for (int i = 0; i < kW; ++i) {
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k)
        columns[(3 * i + k) * ld] = Cb[k][i];
    }
    for (int t = 0; t < seen; ++t) {
      const TwistTarget& target = group.targets[t];
      vd F[6];
      LoadArrays(target.force + lane, target.lanes, F);
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        vd G[3], q[3];
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) {
          G[i] = F[Lower(i, 0)] * C[Lower(k, 0)];
#pragma GCC unroll 3
          for (int m = 1; m <= k; ++m)
            G[i] += F[Lower(i, m)] * C[Lower(k, m)];
        }
        CrossOf(X, G, q);
        const vd w[6] = {-G[0], -G[1], -G[2], -q[0], -q[1], -q[2]};
        StoreSixRows(w, columns + k * ld + 1 + 6 * t, 3 * ld);
      }
    }
  }
}

/// product = W' xi: what the points move by a twist, times -F.
void PointTransposeProduct(const TwistGroup& group, const double* twists, double* product) {
  const Index stride = group.lanes;
  for (Index lane = 0; lane < stride; lane += kW) {
    vd X[3], sum[3] = {Zero(), Zero(), Zero()};
    LoadArrays(group.X + lane, stride, X);
    for (int t = 0; t < group.num_targets && lane < group.targets[t].lanes; ++t) {
      const TwistTarget& target = group.targets[t];
      const double* xi = twists + 6 * t;
      const vd w[3] = {Splat(xi[3]), Splat(xi[4]), Splat(xi[5])};
      vd F[6], moved[3];
      LoadArrays(target.force + lane, target.lanes, F);
      CrossOf(w, X, moved);
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        moved[i] += Splat(xi[i]);
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        sum[i] -= F[Lower(i, 0)] * moved[0] + F[Lower(i, 1)] * moved[1] + F[Lower(i, 2)] * moved[2];
      }
    }
    StoreArrays(sum, true, stride, product + lane);
  }
}

/// sums = W u, pose by pose.
void PointProduct(const TwistGroup& group, const double* u, double* sums) {
  const Index stride = group.lanes;
  for (int t = 0; t < group.num_targets; ++t) {
    const TwistTarget& target = group.targets[t];
    vd sum[6] = {Zero(), Zero(), Zero(), Zero(), Zero(), Zero()};
    for (Index lane = 0; lane < target.lanes; lane += kW) {
      vd X[3], x[3], F[6], f[3], q[3];
      LoadArrays(group.X + lane, stride, X);
      LoadArrays(u + lane, stride, x);
      LoadArrays(target.force + lane, target.lanes, F);
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        f[i] = F[Lower(i, 0)] * x[0] + F[Lower(i, 1)] * x[1] + F[Lower(i, 2)] * x[2];
      CrossOf(X, f, q);
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        sum[i] -= f[i];
        sum[3 + i] -= q[i];
      }
    }
    for (int i = 0; i < 6; ++i)
      sums[6 * t + i] = Sum(sum[i]);
  }
}

void PointSteps(const TwistGroup& group, const double* factor, const double* b,
                const double* product, double* step) {
  const Index stride = group.lanes;
  for (Index lane = 0; lane < stride; lane += kW) {
    vd C[6], x[3], half[3], out[3];
    LoadArrays(factor + lane, stride, C);
    LoadArrays(product + lane, stride, x);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      x[i] = (b != nullptr ? Load(b + i * stride + lane) : Zero()) - x[i];
    TimesFactor(C, x, half);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      out[i] = C[Lower(2, i)] * half[2];
#pragma GCC unroll 3
      for (int k = 1; k >= i; --k)
        out[i] += C[Lower(k, i)] * half[k];
    }
    StoreArrays(out, true, stride, step + lane);
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_POINT_ELIMINATION_H_
