// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// One landmark of any shape: its step, its part of a product with S, and Z = W C'.

#ifndef GLISSADE_KERNELS_IMPL_LANDMARK_H_
#define GLISSADE_KERNELS_IMPL_LANDMARK_H_

#include "kernels/impl/simd.h"
#include "kernels/schur.h"

namespace glissade::kernels {
namespace {

/// out = H_ll^-1 (sign W'x + b): b null is zero.
template <int kDl>
GLISSADE_INLINE void Substitute(const SchurLandmark& l, double sign, const double* b,
                                const double* x, double* out) {
  // Two sums each: additions wait for each other.
  double sum[2][kDl] = {};
  const double* w = l.w;
  for (int a = 0; a < l.blocks; ++a) {
    const double* xa = x + l.row[a];
    const int dim = l.dim[a];
    int r = 0;
    for (; r + 2 <= dim; r += 2, w += 2 * kDl) {
#pragma GCC unroll 4
      for (int k = 0; k < kDl; ++k) {
        sum[0][k] += w[k] * xa[r];
        sum[1][k] += w[kDl + k] * xa[r + 1];
      }
    }
    if (r < dim) {
#pragma GCC unroll 4
      for (int k = 0; k < kDl; ++k)
        sum[0][k] += w[k] * xa[r];
      w += kDl;
    }
  }
  // H_ll^-1 = C'C.
  double half[kDl];
#pragma GCC unroll 4
  for (int r = 0; r < kDl; ++r) {
    half[r] = 0.0;
#pragma GCC unroll 4
    for (int k = 0; k <= r; ++k) {
      half[r] +=
          l.factor[r * kDl + k] * ((b == nullptr ? 0.0 : b[k]) + sign * (sum[0][k] + sum[1][k]));
    }
  }
#pragma GCC unroll 4
  for (int c = 0; c < kDl; ++c) {
    double value = 0.0;
#pragma GCC unroll 4
    for (int r = c; r < kDl; ++r)
      value += l.factor[r * kDl + c] * half[r];
    out[c] = value;
  }
}

template <int kDl>
void SchurMultiplyFor(const SchurLandmark& l, const double* x, double* y) {
  double u[kDl];
  Substitute<kDl>(l, 1.0, nullptr, x, u);
  const double* w = l.w;
  for (int a = 0; a < l.blocks; ++a) {
    double* ya = y + l.row[a];
    for (int r = 0; r < l.dim[a]; ++r, w += kDl) {
      double sum = 0.0;
#pragma GCC unroll 4
      for (int k = 0; k < kDl; ++k)
        sum += w[k] * u[k];
      ya[r] -= sum;
    }
  }
}

/// kW rows of W, one vector per column.
template <int kDl>
GLISSADE_INLINE void LoadRowsOfW(const double* w, vd* column) {
  if constexpr (kDl == 1) {
    column[0] = Load(w);
  } else if constexpr (kDl == 3) {
    // Three vectors hold kW rows of three numbers.
    const vd x = Load(w), y = Load(w + kW), z = Load(w + 2 * kW);
#if GLISSADE_KERNEL_WIDTH == 8
    const vd a = __builtin_shuffle(x, y, vi{0, 3, 6, 9, 12, 15, 0, 0});
    const vd b = __builtin_shuffle(x, y, vi{1, 4, 7, 10, 13, 0, 0, 0});
    const vd c = __builtin_shuffle(x, y, vi{2, 5, 8, 11, 14, 0, 0, 0});
    column[0] = __builtin_shuffle(a, z, vi{0, 1, 2, 3, 4, 5, 10, 13});
    column[1] = __builtin_shuffle(b, z, vi{0, 1, 2, 3, 4, 8, 11, 14});
    column[2] = __builtin_shuffle(c, z, vi{0, 1, 2, 3, 4, 9, 12, 15});
#elif GLISSADE_KERNEL_WIDTH == 4
    const vd a = __builtin_shuffle(x, y, vi{0, 3, 6, 6});
    const vd b = __builtin_shuffle(x, y, vi{1, 4, 7, 7});
    const vd c = __builtin_shuffle(x, y, vi{2, 5, 5, 5});
    column[0] = __builtin_shuffle(a, z, vi{0, 1, 2, 5});
    column[1] = __builtin_shuffle(b, z, vi{0, 1, 2, 6});
    column[2] = __builtin_shuffle(c, z, vi{0, 1, 4, 7});
#else
    column[0] = __builtin_shuffle(x, y, vi{0, 3});
    column[1] = __builtin_shuffle(x, z, vi{1, 2});
    column[2] = __builtin_shuffle(y, z, vi{0, 3});
#endif
  } else {
#pragma GCC unroll 4
    for (int k = 0; k < kDl; ++k)
      column[k] = LoadStrided(w + k, kDl);
  }
}

template <int kDl>
void PanelFor(const SchurLandmark& l, double* z, double* beta) {
  vd factor[kDl][kDl];
#pragma GCC unroll 4
  for (int k = 0; k < kDl; ++k) {
    double sum = 0.0;
#pragma GCC unroll 4
    for (int i = 0; i <= k; ++i) {
      factor[k][i] = Splat(l.factor[k * kDl + i]);
      sum += l.factor[k * kDl + i] * l.b[i];
    }
    beta[k] = sum;
  }
  const double* w = l.w;
  for (int a = 0; a < l.blocks; ++a) {
    const int dim = l.dim[a];
    int r = 0;
    // A block that fills more than half a vector is one: what is stored behind a column is where
    // the next one, or the next block, comes.
    for (; r + kW <= dim || (r == 0 && 2 * dim > kW); r += kW) {
      vd x[kDl];
      LoadRowsOfW<kDl>(w + r * kDl, x);
#pragma GCC unroll 4
      for (int k = 0; k < kDl; ++k) {
        vd sum = x[0] * factor[k][0];
#pragma GCC unroll 4
        for (int i = 1; i <= k; ++i)
          sum += x[i] * factor[k][i];
        Store(z + k * dim + r, sum);
      }
    }
    for (; r < dim; ++r) {
#pragma GCC unroll 4
      for (int k = 0; k < kDl; ++k) {
        double sum = w[r * kDl] * l.factor[k * kDl];
#pragma GCC unroll 4
        for (int i = 1; i <= k; ++i)
          sum += w[r * kDl + i] * l.factor[k * kDl + i];
        z[k * dim + r] = sum;
      }
    }
    w += dim * kDl;
    z += dim * kDl;
  }
}

void LandmarkStep(const SchurLandmark* l, const double* x, double* step) {
  switch (l->dl) {
    case 1:
      return Substitute<1>(*l, -1.0, l->b, x, step);
    case 2:
      return Substitute<2>(*l, -1.0, l->b, x, step);
    case 3:
      return Substitute<3>(*l, -1.0, l->b, x, step);
    default:
      return Substitute<4>(*l, -1.0, l->b, x, step);
  }
}

void SchurMultiply(const SchurLandmark* l, const double* x, double* y) {
  switch (l->dl) {
    case 1:
      return SchurMultiplyFor<1>(*l, x, y);
    case 2:
      return SchurMultiplyFor<2>(*l, x, y);
    case 3:
      return SchurMultiplyFor<3>(*l, x, y);
    default:
      return SchurMultiplyFor<4>(*l, x, y);
  }
}

void SchurPanelOf(const SchurLandmark* l, double* z, double* beta) {
  switch (l->dl) {
    case 1:
      return PanelFor<1>(*l, z, beta);
    case 2:
      return PanelFor<2>(*l, z, beta);
    case 3:
      return PanelFor<3>(*l, z, beta);
    default:
      return PanelFor<4>(*l, z, beta);
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_LANDMARK_H_
