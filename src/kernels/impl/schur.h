// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// One landmark of the generic Schur complement: S -= W H_ll^-1 W' and what belongs to it.
//
// S is column-major, so lanes run along rows. Blocks that are neighbours in a block column (a
// landmark is mostly seen by consecutive cameras) form a run whose rows are contiguous in S and in
// the transposed W alike; the update works on whole runs, and only the tail of a run is a partial
// vector.

#ifndef GLISSADE_KERNELS_IMPL_SCHUR_H_
#define GLISSADE_KERNELS_IMPL_SCHUR_H_

#include "kernels/impl/simd.h"
#include "kernels/schur.h"

namespace glissade::kernels {
namespace {

/// One vector of rows of one column: s(0:kW) -= sum_k w(:, k) y(k), the first `last` lanes.
template <int kDl, bool kPartial>
GLISSADE_INLINE void LaneUpdate(const vd (&w)[kDl], const double* y, Index ld, double* s,
                                int last) {
  vd x = kPartial ? LoadPartial(s, last) : Load(s);
#pragma GCC unroll 4
  for (int k = 0; k < kDl; ++k)
    x -= w[k] * Splat(y[k * ld]);
  if (kPartial) {
    StorePartial(s, x, last);
  } else {
    Store(s, x);
  }
}

template <int kColumns, int kDl, bool kPartial>
GLISSADE_INLINE void RowsUpdate(int columns, const double* w, const double* y, Index ld, double* s,
                                Index lds, int last) {
  vd wi[kDl];
#pragma GCC unroll 4
  for (int k = 0; k < kDl; ++k)
    wi[k] = Load(w + k * ld);
  if (kColumns > 0) {
#pragma GCC unroll 16
    for (int c = 0; c < kColumns; ++c)
      LaneUpdate<kDl, kPartial>(wi, y + c, ld, s + c * lds, last);
  } else {
#pragma GCC unroll 1
    for (int c = 0; c < columns; ++c)
      LaneUpdate<kDl, kPartial>(wi, y + c, ld, s + c * lds, last);
  }
}

/// s(0:rows, 0:columns) -= w y', both with dl columns, ld apart. kColumns 0: the count is the
/// argument.
template <int kColumns, int kDl>
__attribute__((noinline)) void RunUpdate(int rows, int columns, const double* w, const double* y,
                                         Index ld, double* s, Index lds) {
  int i = 0;
#pragma GCC unroll 1
  for (; i + kW <= rows; i += kW)
    RowsUpdate<kColumns, kDl, false>(columns, w + i, y, ld, s + i, lds, kW);
  if (i < rows) RowsUpdate<kColumns, kDl, true>(columns, w + i, y, ld, s + i, lds, rows - i);
}

/// The same for one block of kDim x kDim: everything unrolled, W in registers.
template <int kDim, int kDl>
__attribute__((noinline)) void BlockUpdate(const double* w, const double* y, Index ld, double* s,
                                           Index lds) {
  constexpr int kFull = kDim / kW;
  constexpr int kLast = kDim % kW;
  vd x[kDl][kFull + 1];
#pragma GCC unroll 4
  for (int k = 0; k < kDl; ++k) {
#pragma GCC unroll 9
    for (int v = 0; v < kFull + (kLast > 0 ? 1 : 0); ++v)
      x[k][v] = Load(w + k * ld + v * kW);
  }
#pragma GCC unroll 16
  for (int c = 0; c < kDim; ++c, s += lds) {
    vd yc[kDl];
#pragma GCC unroll 4
    for (int k = 0; k < kDl; ++k)
      yc[k] = Splat(y[c + k * ld]);
#pragma GCC unroll 8
    for (int v = 0; v < kFull; ++v) {
      vd p = Load(s + v * kW);
#pragma GCC unroll 4
      for (int k = 0; k < kDl; ++k)
        p -= x[k][v] * yc[k];
      Store(s + v * kW, p);
    }
    if (kLast > 0) {
      vd p = LoadFirst<kLast>(s + kFull * kW);
#pragma GCC unroll 4
      for (int k = 0; k < kDl; ++k)
        p -= x[k][kFull] * yc[k];
      StoreFirst<kLast>(s + kFull * kW, p);
    }
  }
}

/// kDim > 0: all blocks have that dimension.
template <int kDim, int kDl>
void SchurUpdateFor(const SchurLandmark& l, const SchurRows& rows, int begin, int end,
                    const SchurTarget& t, double* scratch) {
  const int m = l.blocks;
  const auto dim = [&](int a) { return kDim > 0 ? kDim : l.dim[a]; };
  const double* w = l.w;
  for (int a = 0; a < begin; ++a)
    w += dim(a) * kDl;
  int size = 0, own = 0;
  for (int a = begin; a < m; ++a) {
    size += dim(a);
    if (a < end) own += dim(a);
  }
  // W transposed, of the vertices from `begin` on; Y = W H_ll^-1 of those whose columns are asked
  // for. One whole vector behind the last row may be read.
  const Index ld = (size + 15) / 8 * 8;
  double* const wt = scratch;
  double* const yt = scratch + kDl * ld;
  int at = 0;
  for (; at + kW <= size; at += kW) {
#pragma GCC unroll 4
    for (int k = 0; k < kDl; ++k)
      Store(wt + k * ld + at, LoadStrided(w + at * kDl + k, kDl, kW));
  }
  for (int count = size - at; at < ld; at += kW, count = 1) {
#pragma GCC unroll 4
    for (int k = 0; k < kDl; ++k) {
      // Behind the last row: anything finite.
      const double* last = w + (at < size ? at : size - 1) * kDl + k;
      Store(wt + k * ld + at, LoadStrided(last, kDl, count > 0 ? count : 1));
    }
  }
  vd inverse[kDl][kDl];
#pragma GCC unroll 4
  for (int i = 0; i < kDl; ++i) {
#pragma GCC unroll 4
    for (int k = 0; k < kDl; ++k)
      inverse[i][k] = Splat(l.inverse[i * kDl + k]);
  }
  for (at = 0; at < own; at += kW) {
    vd x[kDl];
#pragma GCC unroll 4
    for (int k = 0; k < kDl; ++k)
      x[k] = Load(wt + k * ld + at);
#pragma GCC unroll 4
    for (int k = 0; k < kDl; ++k) {
      vd y = x[0] * inverse[0][k];
#pragma GCC unroll 4
      for (int i = 1; i < kDl; ++i)
        y += x[i] * inverse[i][k];
      Store(yt + k * ld + at, y);
    }
  }

  const double* wc = wt;
  const double* y = yt;
  for (int c = begin; c < end; ++c) {
    const int columns = dim(c);
    double* b = t.b + l.row[c];
    for (int r = 0; r < columns; ++r) {
      double sum = 0.0;
#pragma GCC unroll 4
      for (int k = 0; k < kDl; ++k)
        sum += y[k * ld + r] * l.b[k];
      b[r] -= sum;
    }
    const int32_t vertex = l.vertex[c];
    double* const column = t.s + t.column[vertex];
    const Index stride = t.stride[vertex];
    if (rows.row == nullptr) {
      RunUpdate<kDim, kDl>(columns, columns, wc, y, ld, column, stride);
    } else {
      // Row of vertex a in this column.
      const int32_t* row = rows.row;
      if (rows.packed) row += Index{c} * (m - 1) - Index{c} * (c - 1) / 2;
      const double* wa = wc;
      for (int a = c; a < m;) {
        const int first = row[a];
        int count = dim(a);
        int next = a + 1;
        for (; next < m && row[next] == first + count; ++next)
          count += dim(next);
        if (kDim > 0 && next == a + 1) {
          BlockUpdate<kDim, kDl>(wa, y, ld, column + first, stride);
        } else {
          RunUpdate<kDim, kDl>(count, columns, wa, y, ld, column + first, stride);
        }
        wa += count;
        a = next;
      }
    }
    wc += columns;
    y += columns;
  }
}

template <int kDim>
inline void SchurUpdateUniform(const SchurLandmark& l, const SchurRows& rows, int begin, int end,
                               const SchurTarget& t, double* scratch) {
  switch (l.dl) {
    case 1:
      return SchurUpdateFor<kDim, 1>(l, rows, begin, end, t, scratch);
    case 2:
      return SchurUpdateFor<kDim, 2>(l, rows, begin, end, t, scratch);
    case 3:
      return SchurUpdateFor<kDim, 3>(l, rows, begin, end, t, scratch);
    default:
      return SchurUpdateFor<kDim, 4>(l, rows, begin, end, t, scratch);
  }
}

void SchurUpdate(const SchurLandmark* l, SchurRows rows, int begin, int end, const SchurTarget* t,
                 double* scratch) {
  if (begin >= end) return;
  bool uniform = true;
  for (int a = begin + 1; a < l->blocks; ++a)
    uniform &= l->dim[a] == l->dim[begin];
  for (int a = 0; a < begin; ++a)
    uniform &= l->dim[a] == l->dim[begin];
  switch (uniform ? l->dim[begin] : 0) {
    case 6:
      return SchurUpdateUniform<6>(*l, rows, begin, end, *t, scratch);
    case 9:
      return SchurUpdateUniform<9>(*l, rows, begin, end, *t, scratch);
    case 15:
      return SchurUpdateUniform<15>(*l, rows, begin, end, *t, scratch);
    default:
      return SchurUpdateUniform<0>(*l, rows, begin, end, *t, scratch);
  }
}

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
  double rhs[kDl];
#pragma GCC unroll 4
  for (int k = 0; k < kDl; ++k)
    rhs[k] = (b == nullptr ? 0.0 : b[k]) + sign * (sum[0][k] + sum[1][k]);
#pragma GCC unroll 4
  for (int r = 0; r < kDl; ++r) {
    double value = 0.0;
#pragma GCC unroll 4
    for (int c = 0; c < kDl; ++c)
      value += l.inverse[r * kDl + c] * rhs[c];
    out[r] = value;
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

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_SCHUR_H_
