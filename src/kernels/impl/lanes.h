// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What happens to the rows of a run of edges once they are evaluated, whatever the edges are:
// weights, losses, and the sums that go into the normal equations.
//
// A value of a run is an array of lanes, one per edge; row k, column c of a matrix of `dim` columns
// is the array at (k * dim + c) * lanes. `lanes` is a multiple of kLaneBlock.

#ifndef GLISSADE_KERNELS_IMPL_LANES_H_
#define GLISSADE_KERNELS_IMPL_LANES_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

int LanesFinite(int64_t count, const double* x) {
  vd poison[4] = {Zero(), Zero(), Zero(), Zero()};
  int64_t i = 0;
  for (; i + 4 * kW <= count; i += 4 * kW) {
#pragma GCC unroll 4
    for (int u = 0; u < 4; ++u)
      poison[u] += Zero() * Load(x + i + u * kW);
  }
  for (; i < count; i += kW)
    poison[0] += Zero() * Load(x + i);
  return Sum((poison[0] + poison[1]) + (poison[2] + poison[3])) == 0.0 ? 1 : 0;
}

/// x <- L x for matrices of a number of rows that the compiler knows.
template <int kRows>
void WhitenRows(int cols, Index lanes, const double* l, Index l_step, Index l_lane, double* x) {
  for (int c = 0; c < cols; ++c) {
    for (Index s = 0; s < lanes; s += kW) {
      vd in[kRows];
#pragma GCC unroll 4
      for (int k = 0; k < kRows; ++k)
        in[k] = Load(x + (k * cols + c) * lanes + s);
#pragma GCC unroll 4
      for (int k = 0; k < kRows; ++k) {
        vd sum = Zero();
#pragma GCC unroll 4
        for (int m = 0; m < kRows; ++m) {
          const double* entry = l + (k * kRows + m) * l_step;
          sum += (l_lane != 0 ? Load(entry + s) : Splat(*entry)) * in[m];
        }
        Store(x + (k * cols + c) * lanes + s, sum);
      }
    }
  }
}

void WhitenLanes(int rows, int cols, int lanes, const double* l, int per_lane, double* x,
                 double* work) {
  const Index n = lanes, step = per_lane != 0 ? n : 1, lane = per_lane;
  if (rows == 1) return WhitenRows<1>(cols, n, l, step, lane, x);
  if (rows == 2) return WhitenRows<2>(cols, n, l, step, lane, x);
  if (rows == 3) return WhitenRows<3>(cols, n, l, step, lane, x);
  if (rows == 4) return WhitenRows<4>(cols, n, l, step, lane, x);
  for (int c = 0; c < cols; ++c) {
    for (int k = 0; k < rows; ++k) {
      for (Index s = 0; s < n; s += kW) {
        vd sum = Zero();
        for (int m = 0; m < rows; ++m) {
          const double* entry = l + (k * rows + m) * step;
          sum += (lane != 0 ? Load(entry + s) : Splat(*entry)) * Load(x + (m * cols + c) * n + s);
        }
        Store(work + k * n + s, sum);
      }
    }
    for (int k = 0; k < rows; ++k) {
      for (Index s = 0; s < n; s += kW)
        Store(x + (k * cols + c) * n + s, Load(work + k * n + s));
    }
  }
}

double LaneSquares(int rows, int lanes, double scale, const double* mask, double* r,
                   double* squares) {
  vd total = Zero();
  for (Index s = 0; s < lanes; s += kW) {
    const vd factor = mask != nullptr ? Load(mask + s) * Splat(scale) : Splat(scale);
    vd sum = Zero();
    for (int k = 0; k < rows; ++k) {
      double* p = r + static_cast<Index>(k) * lanes + s;
      const vd x = factor * Load(p);
      Store(p, x);
      sum += x * x;
    }
    Store(squares + s, sum);
    total += sum;
  }
  return Sum(total);
}

/// J <- scale (J - alpha_over_s r (r'J)).
void CorrectLanes(int rows, int cols, int lanes, const double* r, const double* scale,
                  const double* alpha_over_s, double* J) {
  const Index n = lanes;
  for (int c = 0; c < cols; ++c) {
    for (Index s = 0; s < n; s += kW) {
      vd projection = Zero();
      for (int k = 0; k < rows; ++k)
        projection += Load(r + k * n + s) * Load(J + (k * cols + c) * n + s);
      // A product that overflows counts for nothing where there is no correction.
      const vd alpha = Load(alpha_over_s + s);
      projection = alpha != Zero() ? projection * alpha : Zero();
      for (int k = 0; k < rows; ++k) {
        double* x = J + (k * cols + c) * n + s;
        Store(x, Load(scale + s) * (Load(x) - projection * Load(r + k * n + s)));
      }
    }
  }
}

void ScaleLanes(int rows, int lanes, const double* scale, double* x) {
  for (Index s = 0; s < lanes; s += kW) {
    const vd factor = Load(scale + s);
    for (int k = 0; k < rows; ++k) {
      double* p = x + static_cast<Index>(k) * lanes + s;
      Store(p, factor * Load(p));
    }
  }
}

// Tile of a product in registers: 24 of 32 accumulate with AVX-512, 9 of 16 otherwise.
#if GLISSADE_KERNEL_WIDTH == 8
constexpr int kLaneTileA = 6, kLaneTileB = 4;
#else
constexpr int kLaneTileA = 3, kLaneTileB = 3;
#endif

/// Adds a tile whose first row and column are i0 and j0. Of a symmetric product only what is not
/// above the diagonal counts, and goes to both places.
template <int kA, int kB>
__attribute__((noinline)) void LaneTile(int rows, Index lanes, const double* a, Index a_row,
                                        const double* b, Index b_row, double alpha, int i0, int j0,
                                        bool symmetric, double* out, Index ldo) {
  constexpr int kTerms = (kA * kB + kW - 1) / kW * kW;
  vd sum[kTerms];
#pragma GCC unroll 32
  for (int i = 0; i < kTerms; ++i)
    sum[i] = Zero();
  a += i0 * lanes;
  b += j0 * lanes;
  for (int k = 0; k < rows; ++k, a += a_row, b += b_row) {
#pragma GCC unroll 1
    for (Index s = 0; s < lanes; s += kW) {
      vd y[kB];
#pragma GCC unroll 4
      for (int j = 0; j < kB; ++j)
        y[j] = Load(b + j * lanes + s);
#pragma GCC unroll 6
      for (int i = 0; i < kA; ++i) {
        const vd x = Load(a + i * lanes + s);
#pragma GCC unroll 4
        for (int j = 0; j < kB; ++j)
          sum[i * kB + j] += x * y[j];
      }
    }
  }
  double totals[kTerms];
#pragma GCC unroll 16
  for (int i = 0; i < kTerms; i += kW)
    Store(totals + i, SumEach(sum + i));
#pragma GCC unroll 6
  for (int i = 0; i < kA; ++i) {
#pragma GCC unroll 4
    for (int j = 0; j < kB; ++j) {
      const Index r = i0 + i, c = j0 + j;
      if (symmetric && c > r) continue;
      out[r * ldo + c] += alpha * totals[i * kB + j];
      if (symmetric && c < r) out[c * ldo + r] += alpha * totals[i * kB + j];
    }
  }
}

template <int kA>
void LaneTileColumns(int columns, int rows, Index lanes, const double* a, Index a_row,
                     const double* b, Index b_row, double alpha, int i0, int j0, bool symmetric,
                     double* out, Index ldo) {
  switch (columns) {
    case 1:
      return LaneTile<kA, 1>(rows, lanes, a, a_row, b, b_row, alpha, i0, j0, symmetric, out, ldo);
    case 2:
      return LaneTile<kA, 2>(rows, lanes, a, a_row, b, b_row, alpha, i0, j0, symmetric, out, ldo);
    case 3:
      return LaneTile<kA, 3>(rows, lanes, a, a_row, b, b_row, alpha, i0, j0, symmetric, out, ldo);
    default:
      return LaneTile<kA, kLaneTileB>(rows, lanes, a, a_row, b, b_row, alpha, i0, j0, symmetric,
                                      out, ldo);
  }
}

void LaneProducts(int rows, int lanes, int dim_a, const double* a, int dim_b, const double* b,
                  double alpha, double* out) {
  const Index n = lanes, a_row = dim_a * n, b_row = dim_b * n, ldo = dim_b;
  const bool same = a == b;
  for (int i = 0; i < dim_a; i += kLaneTileA) {
    const int tall = Min(kLaneTileA, dim_a - i);
    for (int j = 0; j < dim_b && (!same || j < i + tall); j += kLaneTileB) {
      const int wide = Min(kLaneTileB, dim_b - j);
      switch (tall) {
        case 1:
          LaneTileColumns<1>(wide, rows, n, a, a_row, b, b_row, alpha, i, j, same, out, ldo);
          break;
        case 2:
          LaneTileColumns<2>(wide, rows, n, a, a_row, b, b_row, alpha, i, j, same, out, ldo);
          break;
#if GLISSADE_KERNEL_WIDTH == 8
        case 3:
          LaneTileColumns<3>(wide, rows, n, a, a_row, b, b_row, alpha, i, j, same, out, ldo);
          break;
        case 4:
          LaneTileColumns<4>(wide, rows, n, a, a_row, b, b_row, alpha, i, j, same, out, ldo);
          break;
        case 5:
          LaneTileColumns<5>(wide, rows, n, a, a_row, b, b_row, alpha, i, j, same, out, ldo);
          break;
#endif
        default:
          LaneTileColumns<kLaneTileA>(wide, rows, n, a, a_row, b, b_row, alpha, i, j, same, out,
                                      ldo);
          break;
      }
    }
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_LANES_H_
