// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The Schur complement of a batch of landmarks of any shape, block by block: S -= Z Z'.

#ifndef GLISSADE_KERNELS_IMPL_SCHUR_H_
#define GLISSADE_KERNELS_IMPL_SCHUR_H_

#include "kernels/impl/simd.h"
#include "kernels/schur.h"

namespace glissade::kernels {
namespace {

/// Where slots begin. kDim > 0: all have that dimension.
template <int kDim, int kDl>
struct Slots {
  const double* z;
  const int32_t* begin;
  GLISSADE_INLINE const double* At(uint16_t slot) const {
    return kDim > 0 ? z + Index{slot} * (kDim * kDl) : z + begin[slot];
  }
};

/// sum[v][j] = sum over pairs and the dl columns of x(v kW ...) y(j), x of the first slots from row
/// i0 on, y of the second ones from row j0 on. kSwapped: the other way round.
template <int kDim, int kDl, int kV, int kC, bool kSwapped>
GLISSADE_INLINE void SumPairs(const Slots<kDim, kDl>& slots, const SlotPair* pair,
                              const SlotPair* end, Index dim_x, Index dim_y, Index i0, Index j0,
                              vd (&sum)[kV][kC]) {
#pragma GCC unroll 4
  for (int v = 0; v < kV; ++v) {
#pragma GCC unroll 16
    for (int j = 0; j < kC; ++j)
      sum[v][j] = Zero();
  }
#pragma GCC unroll 1
  for (; pair != end; ++pair) {
    const double* x = slots.At(kSwapped ? pair->col : pair->row) + i0;
    const double* y = slots.At(kSwapped ? pair->row : pair->col) + j0;
#pragma GCC unroll 4
    for (int k = 0; k < kDl; ++k) {
      vd xs[kV];
#pragma GCC unroll 4
      for (int v = 0; v < kV; ++v)
        xs[v] = Load(x + k * dim_x + v * kW);
#pragma GCC unroll 16
      for (int j = 0; j < kC; ++j) {
        const vd yj = Splat(y[k * dim_y + j]);
#pragma GCC unroll 4
        for (int v = 0; v < kV; ++v)
          sum[v][j] += xs[v] * yj;
      }
    }
  }
}

GLISSADE_INLINE void SubtractFrom(double* s, vd x, int count) {
  if (count >= kW) {
    Store(s, Load(s) - x);
  } else {
    StorePartial(s, LoadPartial(s, count) - x, count);
  }
}

// Sums of kV vectors and kC columns stay in registers together with the vectors and one factor.
constexpr int kPairRegisters = GLISSADE_KERNEL_WIDTH == 8 ? 32 : 16;

/// kV vectors of rows, of which the last has `last` rows, from row i0 on; all kCols columns.
template <int kDim, int kDl, int kV, int kCols, int kFrom = 0>
GLISSADE_INLINE void BlockRows(const Slots<kDim, kDl>& slots, const SlotPair* pair,
                               const SlotPair* end, int i0, int last, double* s, Index stride) {
  constexpr int kMost = (kPairRegisters - 1 - kV) / kV;
  constexpr int kParts = (kCols + kMost - 1) / kMost;
  constexpr int kC = (kCols + kParts - 1) / kParts;
  constexpr int kNow = kCols - kFrom < kC ? kCols - kFrom : kC;
  vd sum[kV][kNow];
  SumPairs<kDim, kDl, kV, kNow, false>(slots, pair, end, kDim, kDim, i0, kFrom, sum);
#pragma GCC unroll 16
  for (int j = 0; j < kNow; ++j) {
    double* const to = s + i0 + (kFrom + j) * stride;
#pragma GCC unroll 4
    for (int v = 0; v < kV; ++v)
      SubtractFrom(to + v * kW, sum[v][j], v + 1 < kV ? kW : last);
  }
  if constexpr (kFrom + kNow < kCols) {
    BlockRows<kDim, kDl, kV, kCols, kFrom + kNow>(slots, pair, end, i0, last, s, stride);
  }
}

/// A block of kDim x kDim.
template <int kDim, int kDl>
__attribute__((noinline)) void SquareBlock(const Slots<kDim, kDl>& slots, const SlotPair* pair,
                                           const SlotPair* end, double* s, Index stride) {
  constexpr int kLast = kDim % kW;
  // One row that is left over is summed with lanes along its columns.
  constexpr int kV = kLast == 1 ? kDim / kW : (kDim + kW - 1) / kW;
  BlockRows<kDim, kDl, kV, kDim>(slots, pair, end, 0, kLast <= 1 ? kW : kLast, s, stride);
  if constexpr (kLast == 1) {
    constexpr int kW1 = (kDim + kW - 1) / kW;
    vd sum[kW1][1];
    SumPairs<kDim, kDl, kW1, 1, true>(slots, pair, end, kDim, kDim, 0, kDim - 1, sum);
    double row[kW1 * kW];
#pragma GCC unroll 8
    for (int v = 0; v < kW1; ++v)
      Store(row + v * kW, sum[v][0]);
#pragma GCC unroll 16
    for (int j = 0; j < kDim; ++j)
      s[kDim - 1 + j * stride] -= row[j];
  }
}

/// kC columns of a block of any size, from column j0 on.
template <int kDl, int kC>
void BlockColumns(const Slots<0, kDl>& slots, const SlotPair* pair, const SlotPair* end, int rows,
                  int cols, int j0, double* s, Index stride) {
  for (int i0 = 0; i0 < rows; i0 += kW) {
    vd sum[1][kC];
    SumPairs<0, kDl, 1, kC, false>(slots, pair, end, rows, cols, i0, j0, sum);
#pragma GCC unroll 4
    for (int j = 0; j < kC; ++j)
      SubtractFrom(s + i0 + (j0 + j) * stride, sum[0][j], rows - i0);
  }
}

template <int kDl>
void AnyBlock(const Slots<0, kDl>& slots, const SlotPair* pair, const SlotPair* end, int rows,
              int cols, double* s, Index stride) {
  int j = 0;
  for (; j + 4 <= cols; j += 4)
    BlockColumns<kDl, 4>(slots, pair, end, rows, cols, j, s, stride);
  if (j + 2 <= cols) {
    BlockColumns<kDl, 2>(slots, pair, end, rows, cols, j, s, stride);
    j += 2;
  }
  if (j < cols) BlockColumns<kDl, 1>(slots, pair, end, rows, cols, j, s, stride);
}

/// b -= Z beta, of the vertex that all pairs are of.
template <int kDim, int kDl>
GLISSADE_INLINE void BlockRhs(const SchurPanel& panel, const Slots<kDim, kDl>& slots,
                              const SlotPair* pair, const SlotPair* end, int rows, double* b) {
  for (int i0 = 0; i0 < rows; i0 += kW) {
    vd sum = Zero();
    for (const SlotPair* p = pair; p != end; ++p) {
      const double* z = slots.At(p->row) + i0;
      const double* beta = panel.beta + Index{panel.landmark[p->row]} * kDl;
#pragma GCC unroll 4
      for (int k = 0; k < kDl; ++k)
        sum += Load(z + k * rows) * Splat(beta[k]);
    }
    SubtractFrom(b + i0, sum, rows - i0);
  }
}

template <int kDim, int kDl>
void BlocksFor(const SchurPanel& panel, const SchurBlock* block, const SchurBlock* last, double* s,
               double* b) {
  const Slots<kDim, kDl> slots{panel.z, panel.slot};
  for (; block != last; ++block) {
    const SlotPair* const pair = panel.pairs + block->pair_begin;
    const SlotPair* const end = panel.pairs + block->pair_end;
    if constexpr (kDim > 0) {
      SquareBlock<kDim, kDl>(slots, pair, end, s + block->offset, block->stride);
    } else {
      AnyBlock<kDl>(slots, pair, end, block->rows, block->cols, s + block->offset, block->stride);
    }
    if (block->rhs >= 0) {
      BlockRhs<kDim, kDl>(panel, slots, pair, end, kDim > 0 ? kDim : block->rows, b + block->rhs);
    }
  }
}

template <int kDl>
void BlocksOf(const SchurPanel& panel, const SchurBlock* block, const SchurBlock* last, double* s,
              double* b) {
  switch (panel.dim) {
    case 6:
      return BlocksFor<6, kDl>(panel, block, last, s, b);
    case 9:
      return BlocksFor<9, kDl>(panel, block, last, s, b);
    default:
      return BlocksFor<0, kDl>(panel, block, last, s, b);
  }
}

void SchurBlocks(const SchurPanel* panel, int64_t count, const SchurBlock* blocks, double* s,
                 double* b) {
  switch (panel->dl) {
    case 1:
      return BlocksOf<1>(*panel, blocks, blocks + count, s, b);
    case 2:
      return BlocksOf<2>(*panel, blocks, blocks + count, s, b);
    case 3:
      return BlocksOf<3>(*panel, blocks, blocks + count, s, b);
    default:
      return BlocksOf<4>(*panel, blocks, blocks + count, s, b);
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_SCHUR_H_
