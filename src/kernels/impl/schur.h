// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// S -= Y W' for one landmark: the hot loop of the generic Schur complement.
//
// S is column-major, so lanes run along rows. Blocks that are neighbours in S (a landmark is mostly
// seen by consecutive cameras) form a run whose rows are contiguous in S and in Y alike; the update
// works on whole runs, and only the tail of a run is a partial vector.

#ifndef GLISSADE_KERNELS_IMPL_SCHUR_H_
#define GLISSADE_KERNELS_IMPL_SCHUR_H_

#include "kernels/impl/simd.h"

namespace glissade::kernels {
namespace {

// Rows of Y transposed at a time where dl > 1; longer runs are cut.
constexpr int kRunRows = 128;

/// One vector of rows of all columns: s(0:kW, c) -= sum_k y(:, k) w(c, k), the first `last` lanes.
template <int kDl, bool kPartial>
GLISSADE_INLINE void LaneUpdate(const vd (&y)[kDl], const double* w, double* p, int last) {
  vd x = kPartial ? LoadPartial(p, last) : Load(p);
#pragma GCC unroll 4
  for (int k = 0; k < kDl; ++k)
    x -= y[k] * Splat(w[k]);
  if (kPartial) {
    StorePartial(p, x, last);
  } else {
    Store(p, x);
  }
}

template <int kColumns, int kDl, bool kPartial>
GLISSADE_INLINE void RowsUpdate(int columns, const double* y, Index ldy, const double* w, double* s,
                                Index lds, int last) {
  vd yi[kDl];
#pragma GCC unroll 4
  for (int k = 0; k < kDl; ++k) {
    yi[k] = kPartial ? LoadPartial(y + k * ldy, last) : Load(y + k * ldy);
  }
  if (kColumns > 0) {
#pragma GCC unroll 16
    for (int c = 0; c < kColumns; ++c) {
      LaneUpdate<kDl, kPartial>(yi, w + c * kDl, s + c * lds, last);
    }
  } else {
#pragma GCC unroll 1
    for (int c = 0; c < columns; ++c) {
      LaneUpdate<kDl, kPartial>(yi, w + c * kDl, s + c * lds, last);
    }
  }
}

/// s(0:rows, 0:columns) -= y w'; y is column-major rows x dl, w row-major columns x dl.
/// kColumns 0: the count is the argument.
template <int kColumns, int kDl>
__attribute__((noinline)) void RunUpdate(int rows, int columns, const double* y, Index ldy,
                                         const double* w, double* s, Index lds) {
  int i = 0;
#pragma GCC unroll 1
  for (; i + kW <= rows; i += kW) {
    RowsUpdate<kColumns, kDl, false>(columns, y + i, ldy, w, s + i, lds, kW);
  }
  if (i < rows) RowsUpdate<kColumns, kDl, true>(columns, y + i, ldy, w, s + i, lds, rows - i);
}

/// One block row of kDim rows, on its own in S, against the block columns 0 .. blocks - 1:
/// everything unrolled, Y in registers. yt is column-major (ldy), w the blocks of W from the first
/// one on.
template <int kDim, int kDl>
__attribute__((noinline)) void BlockRowUpdate(int blocks, const int32_t* row_offset,
                                              const double* yt, Index ldy, const double* w,
                                              double* s, Index lds) {
  constexpr int kFull = kDim / kW;
  constexpr int kLast = kDim % kW;
  vd y[kDl][kFull + 1];
#pragma GCC unroll 4
  for (int k = 0; k < kDl; ++k) {
#pragma GCC unroll 8
    for (int v = 0; v < kFull; ++v)
      y[k][v] = Load(yt + k * ldy + v * kW);
    if (kLast > 0) y[k][kFull] = LoadFirst<kLast>(yt + k * ldy + kFull * kW);
  }
#pragma GCC unroll 1
  for (int b = 0; b < blocks; ++b) {
    double* column = s + row_offset[b] * lds;
#pragma GCC unroll 16
    for (int c = 0; c < kDim; ++c) {
#pragma GCC unroll 8
      for (int v = 0; v < kFull; ++v) {
        vd x = Load(column + v * kW);
#pragma GCC unroll 4
        for (int k = 0; k < kDl; ++k)
          x -= y[k][v] * Splat(w[c * kDl + k]);
        Store(column + v * kW, x);
      }
      if (kLast > 0) {
        vd x = LoadFirst<kLast>(column + kFull * kW);
#pragma GCC unroll 4
        for (int k = 0; k < kDl; ++k)
          x -= y[k][kFull] * Splat(w[c * kDl + k]);
        StoreFirst<kLast>(column + kFull * kW, x);
      }
      column += lds;
    }
    w += kDim * kDl;
  }
}

/// kDim > 0: all blocks have that dimension.
template <int kDim, int kDl>
void SchurUpdateFor(int m, const int32_t* row_offset, const int32_t* dim, const double* y,
                    const double* w, double* s, Index lds) {
  double transposed[kDl > 1 ? kDl * kRunRows : 1];
  for (int first = 0; first < m;) {
    // The run of blocks [first, end).
    int rows = kDim > 0 ? kDim : dim[first];
    int end = first + 1;
    while (end < m && row_offset[end] == row_offset[first] + rows) {
      const int more = kDim > 0 ? kDim : dim[end];
      if (kDl > 1 && rows + more > kRunRows) break;
      rows += more;
      ++end;
    }
    const double* yt = y;
    if (kDl > 1) {
      for (int r = 0; r < rows; ++r) {
#pragma GCC unroll 4
        for (int k = 0; k < kDl; ++k)
          transposed[r + k * kRunRows] = y[r * kDl + k];
      }
      yt = transposed;
    }
    // Every block column that reaches it; those inside the run start at their own diagonal.
    const double* wb = w;
    double* s_run = s + row_offset[first];
    if constexpr (kDim > 0) {
      if (end == first + 1) {
        BlockRowUpdate<kDim, kDl>(end, row_offset, yt, kRunRows, w, s_run, lds);
        y += rows * kDl;
        first = end;
        continue;
      }
    }
    for (int b = 0; b < first; ++b) {
      const int columns = kDim > 0 ? kDim : dim[b];
      RunUpdate<kDim, kDl>(rows, columns, yt, kRunRows, wb, s_run + row_offset[b] * lds, lds);
      wb += columns * kDl;
    }
    const int all_rows = rows;
    for (int b = first; b < end; ++b) {
      const int columns = kDim > 0 ? kDim : dim[b];
      const int skip = row_offset[b] - row_offset[first];
      RunUpdate<kDim, kDl>(all_rows - skip, columns, yt + skip, kRunRows, wb,
                           s_run + skip + row_offset[b] * lds, lds);
      wb += columns * kDl;
    }
    y += all_rows * kDl;
    first = end;
  }
}

template <int kDim>
inline void SchurUpdateUniform(int m, const int32_t* row_offset, const int32_t* dim, int dl,
                               const double* y, const double* w, double* s, Index lds) {
  switch (dl) {
    case 1:
      SchurUpdateFor<kDim, 1>(m, row_offset, dim, y, w, s, lds);
      return;
    case 2:
      SchurUpdateFor<kDim, 2>(m, row_offset, dim, y, w, s, lds);
      return;
    case 3:
      SchurUpdateFor<kDim, 3>(m, row_offset, dim, y, w, s, lds);
      return;
    default:
      SchurUpdateFor<kDim, 4>(m, row_offset, dim, y, w, s, lds);
      return;
  }
}

void SchurUpdate(int m, const int32_t* row_offset, const int32_t* dim, int dl, const double* y,
                 const double* w, double* s, int lds) {
  if (m <= 0) return;
  bool uniform = true;
  for (int a = 1; a < m; ++a)
    uniform &= dim[a] == dim[0];
  switch (uniform ? dim[0] : 0) {
    case 6:
      SchurUpdateUniform<6>(m, row_offset, dim, dl, y, w, s, lds);
      return;
    case 9:
      SchurUpdateUniform<9>(m, row_offset, dim, dl, y, w, s, lds);
      return;
    case 15:
      SchurUpdateUniform<15>(m, row_offset, dim, dl, y, w, s, lds);
      return;
    default:
      SchurUpdateUniform<0>(m, row_offset, dim, dl, y, w, s, lds);
      return;
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_SCHUR_H_
