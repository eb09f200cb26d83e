// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The elimination of groups (kernels/twists.h), of one number or of points; sums over groups and
// the map from twists to the tangent after it.

#ifndef GLISSADE_KERNELS_IMPL_TWIST_BLOCKS_H_
#define GLISSADE_KERNELS_IMPL_TWIST_BLOCKS_H_

#include "kernels/impl/point_elimination.h"
#include "kernels/impl/twists.h"

namespace glissade::kernels {
namespace {

int ScalarPivots(int count, const double* h, const double* b, double lambda, double min_diagonal,
                 double max_diagonal, double* scale, double* beta) {
  const vd low = Splat(min_diagonal), high = Splat(max_diagonal);
  int first_bad = -1;
  for (int lane = 0; lane < count; lane += kW) {
    const vd x = Load(h + lane);
    vd d = x < low ? low : x;
    d = d > high ? high : d;
    const vd pivot = x + Splat(lambda) * d;
    // Positive and finite; padding has no pivot, and stays out.
    const vi good = (pivot > Zero()) & (pivot < Splat(__builtin_inf()));
    const vd safe = good ? pivot : Splat(1.0);
    const vd inverse = good ? Splat(1.0) / safe : Zero();
    const vd root = Sqrt(inverse);
    const vd bl = Load(b + lane) * root;
    for (int i = 0; i < kW; ++i) {
      if (lane + i >= count) {
        scale[lane + i] = beta[lane + i] = 0.0;
      } else if (good[i] == 0 && first_bad < 0) {
        first_bad = lane + i;
      }
    }
    if (lane + kW <= count) {
      Store(scale + lane, root);
      Store(beta + lane, bl);
    } else {
      StorePartial(scale + lane, root, count - lane);
      StorePartial(beta + lane, bl, count - lane);
    }
  }
  return first_bad;
}

int LandmarkPivots(const TwistGroup* group, const double* h, const double* b, double lambda,
                   double min_diagonal, double max_diagonal, double* factor, double* beta) {
  return group->dim == 1
             ? ScalarPivots(group->used, h, b, lambda, min_diagonal, max_diagonal, factor, beta)
             : PointPivots(*group, h, b, lambda, min_diagonal, max_diagonal, factor, beta);
}

void LandmarkSteps(const TwistGroup* group, const double* factor, const double* b,
                   const double* product, double* step) {
  if (group->dim != 1) return PointSteps(*group, factor, b, product, step);
  for (Index lane = 0; lane < group->lanes; lane += kW) {
    const vd scale = Load(factor + lane);
    const vd x = (b != nullptr ? Load(b + lane) : Zero()) - Load(product + lane);
    Store(step + lane, scale * (scale * x));
  }
}

void TwistPanel(const TwistGroup* group, const double* factor, const double* beta, double* W) {
  group->dim == 1 ? ScalarPanel(group, factor, beta, W) : PointPanel(*group, factor, beta, W);
}

void TwistTransposeProduct(const TwistGroup* group, const double* twists, double* product) {
  group->dim == 1 ? ScalarTransposeProduct(group, twists, product)
                  : PointTransposeProduct(*group, twists, product);
}

void TwistProduct(const TwistGroup* group, const double* u, double* sums) {
  group->dim == 1 ? ScalarProduct(group, u, sums) : PointProduct(*group, u, sums);
}

// Blocks have columns of 8, so that they are moved in whole vectors: masked ones that overlap the
// column before would wait for its store.
constexpr int kTwistStride = 8;
constexpr int kTwistBlock = 6 * kTwistStride;

void AddTwistBlocks(int frames, const int32_t* map, const double* reduced, int stride,
                    double* blocks) {
  const Index ld = stride;
  for (int i = 0; i < frames; ++i) {
    for (int j = 0; j <= i; ++j, ++map) {
      if (*map == INT32_MIN) continue;
      const double* from = reduced + 6 * i + 6 * j * ld;
      if (*map >= 0) {
        double* to = blocks + kTwistBlock * static_cast<Index>(*map);
#pragma GCC unroll 6
        for (int c = 0; c < 6; ++c) {
#pragma GCC unroll 4
          for (int v = 0; v < kTwistStride; v += kW) {
            Store(to + kTwistStride * c + v,
                  Load(to + kTwistStride * c + v) + Load(from + c * ld + v));
          }
        }
      } else {
        double* to = blocks + kTwistBlock * static_cast<Index>(~*map);
        for (int c = 0; c < 6; ++c) {
#pragma GCC unroll 6
          for (int r = 0; r < 6; ++r)
            to[kTwistStride * r + c] += from[r + c * ld];
        }
      }
    }
  }
}

/// out += alpha T_i' B T_j, all 6 x 6 row-major; T = [I, X; 0, R] with rows of kTwistStride. Rows
/// are taken as columns 0 and 1, of which T has those of the identity, and 2 to 5.
void MapBlock(double alpha, const double* Ti, const double* B, int ldb, const double* Tj,
              double* out, int row_stride) {
  v2 low[6];
  v4 high[6];
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r) {
    const double* b = B + r * ldb;
    low[r] = Load2(b);
    v4 sum = Load4(Tj + 2) * b[0];
#pragma GCC unroll 5
    for (int k = 1; k < 6; ++k)
      sum += Load4(Tj + k * kTwistStride + 2) * b[k];
    high[r] = sum;
  }
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r) {
    v2 x = r < 3 ? low[r] : low[0] * Ti[r];
    v4 y = r < 3 ? high[r] : high[0] * Ti[r];
#pragma GCC unroll 5
    for (int k = 1; k < 6; ++k) {
      if (r < 3) continue;
      x += low[k] * Ti[k * kTwistStride + r];
      y += high[k] * Ti[k * kTwistStride + r];
    }
    double* to = out + r * row_stride;
    Store2(to, Load2(to) + alpha * x);
    Store4(to + 2, Load4(to + 2) + alpha * y);
  }
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_TWIST_BLOCKS_H_
