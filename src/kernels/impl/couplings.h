// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Products of a run that each lane has for itself: what its edge adds to its landmark's record.

#ifndef GLISSADE_KERNELS_IMPL_COUPLINGS_H_
#define GLISSADE_KERNELS_IMPL_COUPLINGS_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

/// Numbers of each lane that are put together before they go to their places.
constexpr int kMostNumbers = 64;

/// v[i] becomes lane i of all kW of them.
GLISSADE_INLINE void Transpose(vd* v) {
#if GLISSADE_KERNEL_WIDTH == 8
  vd p[8], q[8];
#pragma GCC unroll 4
  for (int i = 0; i < 8; i += 2) {
    p[i] = __builtin_shuffle(v[i], v[i + 1], vi{0, 8, 2, 10, 4, 12, 6, 14});
    p[i + 1] = __builtin_shuffle(v[i], v[i + 1], vi{1, 9, 3, 11, 5, 13, 7, 15});
  }
#pragma GCC unroll 2
  for (int i = 0; i < 8; i += 4) {
#pragma GCC unroll 2
    for (int j = i; j < i + 2; ++j) {
      q[j] = __builtin_shuffle(p[j], p[j + 2], vi{0, 1, 8, 9, 4, 5, 12, 13});
      q[j + 2] = __builtin_shuffle(p[j], p[j + 2], vi{2, 3, 10, 11, 6, 7, 14, 15});
    }
  }
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    v[i] = __builtin_shuffle(q[i], q[i + 4], vi{0, 1, 2, 3, 8, 9, 10, 11});
    v[i + 4] = __builtin_shuffle(q[i], q[i + 4], vi{4, 5, 6, 7, 12, 13, 14, 15});
  }
#elif GLISSADE_KERNEL_WIDTH == 4
  const vd a = __builtin_shuffle(v[0], v[1], vi{0, 4, 2, 6});
  const vd b = __builtin_shuffle(v[0], v[1], vi{1, 5, 3, 7});
  const vd c = __builtin_shuffle(v[2], v[3], vi{0, 4, 2, 6});
  const vd d = __builtin_shuffle(v[2], v[3], vi{1, 5, 3, 7});
  v[0] = __builtin_shuffle(a, c, vi{0, 1, 4, 5});
  v[1] = __builtin_shuffle(b, d, vi{0, 1, 4, 5});
  v[2] = __builtin_shuffle(a, c, vi{2, 3, 6, 7});
  v[3] = __builtin_shuffle(b, d, vi{2, 3, 6, 7});
#else
  const vd a = v[0];
  v[0] = __builtin_shuffle(a, v[1], vi{0, 2});
  v[1] = __builtin_shuffle(a, v[1], vi{1, 3});
#endif
}

/// n numbers of each of the first `count` (at most kW) lanes, from `numbers` (arrays of kW lanes;
/// up to kW of them more are read) to base[offset[lane] ...].
template <bool kAdds>
GLISSADE_INLINE void Scatter(int n, int count, const double* numbers, const int64_t* offset,
                             double* base) {
  for (int first = 0; first < n; first += kW) {
    vd v[kW];
#pragma GCC unroll 8
    for (int i = 0; i < kW; ++i)
      v[i] = Load(numbers + (first + i) * kW);
    Transpose(v);
    const int size = Min(kW, n - first);
    if (size == kW && count == kW) {
#pragma GCC unroll 8
      for (int lane = 0; lane < kW; ++lane) {
        double* const to = base + offset[lane] + first;
        Store(to, kAdds ? Load(to) + v[lane] : v[lane]);
      }
      continue;
    }
#pragma GCC unroll 8
    for (int lane = 0; lane < kW; ++lane) {
      if (lane >= count) break;
      double* const to = base + offset[lane] + first;
      StorePartial(to, kAdds ? LoadPartial(to, size) + v[lane] : v[lane], size);
    }
  }
}

/// The places of lanes are all over a chunk's records: their lines are asked for ahead of time.
GLISSADE_INLINE void PrefetchPlaces(int n, const int64_t* offset, Index count, double* base) {
  for (Index lane = 0; lane < count; ++lane) {
    for (int k = 0; k < n; k += 8)
      __builtin_prefetch(base + offset[lane] + k, 1);
  }
}

/// kRows 0: the argument.
template <int kRows, int kB, bool kAdds>
void CouplingsFor(int rows, Index n, int count, int dim_a, const double* a, const double* b,
                  const int64_t* offset, double* base) {
  constexpr int kTall = kMostNumbers / kB;
  const Index a_row = dim_a * n, b_row = kB * n;
  if (kRows > 0) rows = kRows;
  double block[(kMostNumbers + kW) * kW];
  // What is read beyond the last number is stored nowhere, but is to be finite all the same.
  for (int k = 0; k < kW; ++k)
    Store(block + Min(dim_a * kB, kMostNumbers) * kW + k * kW, Zero());
  for (Index s = 0; s < count; s += kW) {
    PrefetchPlaces(dim_a * kB, offset + s + kW, Min<Index>(kW, count - s - kW), base);
    vd y[kRows > 0 ? kRows : 1][kB];
    if constexpr (kRows > 0) {
#pragma GCC unroll 4
      for (int k = 0; k < kRows; ++k) {
#pragma GCC unroll 4
        for (int j = 0; j < kB; ++j)
          y[k][j] = Load(b + k * b_row + j * n + s);
      }
    }
    for (int i0 = 0; i0 < dim_a; i0 += kTall) {
      const int tall = Min(kTall, dim_a - i0);
      for (int i = 0; i < tall; ++i) {
        const double* x = a + (i0 + i) * n + s;
        vd sum[kB];
        if constexpr (kRows > 0) {
          const vd first = Load(x);
#pragma GCC unroll 4
          for (int j = 0; j < kB; ++j)
            sum[j] = first * y[0][j];
#pragma GCC unroll 4
          for (int k = 1; k < kRows; ++k) {
            const vd next = Load(x + k * a_row);
#pragma GCC unroll 4
            for (int j = 0; j < kB; ++j)
              sum[j] += next * y[k][j];
          }
        } else {
#pragma GCC unroll 4
          for (int j = 0; j < kB; ++j)
            sum[j] = Zero();
          for (int k = 0; k < rows; ++k) {
            const vd next = Load(x + k * a_row);
#pragma GCC unroll 4
            for (int j = 0; j < kB; ++j)
              sum[j] += next * Load(b + k * b_row + j * n + s);
          }
        }
#pragma GCC unroll 4
        for (int j = 0; j < kB; ++j)
          Store(block + (i * kB + j) * kW, sum[j]);
      }
      Scatter<kAdds>(tall * kB, Min<int>(kW, count - static_cast<int>(s)), block, offset + s,
                     base + i0 * kB);
    }
  }
}

template <int kB>
void CouplingsOf(int rows, int lanes, int count, int dim_a, const double* a, const double* b,
                 const int64_t* offset, bool sets, double* base) {
  if (rows == 2) {
    return sets ? CouplingsFor<2, kB, false>(2, lanes, count, dim_a, a, b, offset, base)
                : CouplingsFor<2, kB, true>(2, lanes, count, dim_a, a, b, offset, base);
  }
  return sets ? CouplingsFor<0, kB, false>(rows, lanes, count, dim_a, a, b, offset, base)
              : CouplingsFor<0, kB, true>(rows, lanes, count, dim_a, a, b, offset, base);
}

void LaneCouplings(int rows, int lanes, int count, int dim_a, const double* a, int dim_b,
                   const double* b, const int64_t* offset, bool sets, double* base) {
  switch (dim_b) {
    case 1:
      return CouplingsOf<1>(rows, lanes, count, dim_a, a, b, offset, sets, base);
    case 2:
      return CouplingsOf<2>(rows, lanes, count, dim_a, a, b, offset, sets, base);
    case 3:
      return CouplingsOf<3>(rows, lanes, count, dim_a, a, b, offset, sets, base);
    default:
      return CouplingsOf<4>(rows, lanes, count, dim_a, a, b, offset, sets, base);
  }
}

template <int kDl>
void LandmarksOf(int rows, Index n, int count, const double* J, const double* r,
                 const int64_t* offset, double* base) {
  constexpr int kNumbers = kDl * kDl + kDl;
  double block[(kNumbers + kW) * kW];
  for (int k = 0; k < kW; ++k)
    Store(block + (kNumbers + k) * kW, Zero());
  for (Index s = 0; s < count; s += kW) {
    PrefetchPlaces(kNumbers, offset + s + kW, Min<Index>(kW, count - s - kW), base);
    vd H[kDl][kDl], b[kDl];
#pragma GCC unroll 4
    for (int i = 0; i < kDl; ++i) {
      b[i] = Zero();
#pragma GCC unroll 4
      for (int j = 0; j <= i; ++j)
        H[i][j] = Zero();
    }
    for (int k = 0; k < rows; ++k) {
      const vd e = Load(r + k * n + s);
      vd x[kDl];
#pragma GCC unroll 4
      for (int i = 0; i < kDl; ++i) {
        x[i] = Load(J + (k * kDl + i) * n + s);
        b[i] -= x[i] * e;
#pragma GCC unroll 4
        for (int j = 0; j <= i; ++j)
          H[i][j] += x[i] * x[j];
      }
    }
#pragma GCC unroll 4
    for (int i = 0; i < kDl; ++i) {
      Store(block + (kDl * kDl + i) * kW, b[i]);
#pragma GCC unroll 4
      for (int j = 0; j < kDl; ++j)
        Store(block + (kDl * i + j) * kW, i >= j ? H[i][j] : H[j][i]);
    }
    Scatter<true>(kNumbers, Min<int>(kW, count - static_cast<int>(s)), block, offset + s, base);
  }
}

void LaneLandmarks(int rows, int lanes, int count, int dl, const double* J, const double* r,
                   const int64_t* offset, double* base) {
  switch (dl) {
    case 1:
      return LandmarksOf<1>(rows, lanes, count, J, r, offset, base);
    case 2:
      return LandmarksOf<2>(rows, lanes, count, J, r, offset, base);
    case 3:
      return LandmarksOf<3>(rows, lanes, count, J, r, offset, base);
    default:
      return LandmarksOf<4>(rows, lanes, count, J, r, offset, base);
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_COUPLINGS_H_
