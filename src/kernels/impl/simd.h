// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The vector type of the kernels: kW doubles, a GCC vector extension type.
//
// GLISSADE_KERNEL_WIDTH is set by the translation unit (2, 4 or 8). Everything in impl/ sits in an
// unnamed namespace and is included by one translation unit per instruction set.

#ifndef GLISSADE_KERNELS_IMPL_SIMD_H_
#define GLISSADE_KERNELS_IMPL_SIMD_H_

#include <stddef.h>
#include <stdint.h>

#define GLISSADE_INLINE inline __attribute__((always_inline))

namespace glissade::kernels {
namespace {

constexpr int kW = GLISSADE_KERNEL_WIDTH;

typedef double vd __attribute__((vector_size(8 * kW)));
typedef int64_t vi __attribute__((vector_size(8 * kW)));
// The same in memory: aligned as a double, and allowed to alias the doubles it is made of.
typedef double vd_mem __attribute__((vector_size(8 * kW), aligned(8), may_alias));

typedef ptrdiff_t Index;

GLISSADE_INLINE vd Load(const double* p) {
  return *reinterpret_cast<const vd_mem*>(p);
}
GLISSADE_INLINE void Store(double* p, vd v) {
  *reinterpret_cast<vd_mem*>(p) = v;
}

// For what is small: rows of 3 or 6 numbers. Where registers are narrower a v4 is two of them; all
// is inlined, so that how it would be passed to a function does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"
typedef double v2 __attribute__((vector_size(16)));
typedef double v4 __attribute__((vector_size(32)));
typedef int64_t v4i __attribute__((vector_size(32)));
typedef double v2_mem __attribute__((vector_size(16), aligned(8), may_alias));
typedef double v4_mem __attribute__((vector_size(32), aligned(8), may_alias));

GLISSADE_INLINE v2 Load2(const double* p) {
  return *reinterpret_cast<const v2_mem*>(p);
}
GLISSADE_INLINE v4 Load4(const double* p) {
  return *reinterpret_cast<const v4_mem*>(p);
}
GLISSADE_INLINE void Store2(double* p, const v2& v) {
  *reinterpret_cast<v2_mem*>(p) = v;
}
GLISSADE_INLINE void Store4(double* p, const v4& v) {
  *reinterpret_cast<v4_mem*>(p) = v;
}

GLISSADE_INLINE vd Splat(double x) {
#if GLISSADE_KERNEL_WIDTH == 8
  return vd{x, x, x, x, x, x, x, x};
#elif GLISSADE_KERNEL_WIDTH == 4
  return vd{x, x, x, x};
#else
  return vd{x, x};
#endif
}

GLISSADE_INLINE vd Zero() {
  return vd{};
}

/// x, rounded: what is made of it is not contracted with the product it comes from. So that two
/// functions that differ in what else they use it for get the same bits.
GLISSADE_INLINE vd Rounded(vd x) {
#if defined(__x86_64__)
  asm("" : "+v"(x));
#elif defined(__aarch64__)
  asm("" : "+w"(x));
#endif
  return x;
}

/// The first `count` (1 to kW) doubles at p, zeros in the other lanes, whose memory is not touched.
GLISSADE_INLINE vd LoadPartial(const double* p, int count) {
#if GLISSADE_KERNEL_WIDTH == 8
  return __builtin_ia32_loadupd512_mask(p, vd{}, static_cast<unsigned char>((1 << count) - 1));
#elif GLISSADE_KERNEL_WIDTH == 4
  static const long long kLanes[8] = {-1, -1, -1, -1, 0, 0, 0, 0};
  typedef long long mask_mem __attribute__((vector_size(32), aligned(8), may_alias));
  const mask_mem mask = *reinterpret_cast<const mask_mem*>(kLanes + 4 - count);
  return __builtin_ia32_maskloadpd256(reinterpret_cast<const vd*>(p), mask);
#else
  return count >= 2 ? Load(p) : vd{p[0], 0.0};
#endif
}

/// kW doubles, `stride` apart. Put together in registers: a vector that was stored as scalars a
/// moment ago would wait for the last of them to reach the cache.
GLISSADE_INLINE vd LoadStrided(const double* p, Index stride) {
#if GLISSADE_KERNEL_WIDTH == 8
  return vd{p[0],          p[stride],     p[2 * stride], p[3 * stride],
            p[4 * stride], p[5 * stride], p[6 * stride], p[7 * stride]};
#elif GLISSADE_KERNEL_WIDTH == 4
  return vd{p[0], p[stride], p[2 * stride], p[3 * stride]};
#else
  return vd{p[0], p[stride]};
#endif
}

/// Stores the first `count` (1 to kW) lanes, touching no other memory.
GLISSADE_INLINE void StorePartial(double* p, vd v, int count) {
#if GLISSADE_KERNEL_WIDTH == 8
  __builtin_ia32_storeupd512_mask(p, v, static_cast<unsigned char>((1 << count) - 1));
#elif GLISSADE_KERNEL_WIDTH == 4
  // Branches, not vmaskmovpd: as a store that is microcoded on several AMD generations.
  if (count == 4) {
    Store(p, v);
    return;
  }
  if (count & 2) {
    typedef double v2 __attribute__((vector_size(16), aligned(8), may_alias));
    *reinterpret_cast<v2*>(p) = v2{v[0], v[1]};
    if (count & 1) p[2] = v[2];
  } else {
    p[0] = v[0];
  }
#else
  if (count >= 2) {
    Store(p, v);
  } else {
    p[0] = v[0];
  }
#endif
}

GLISSADE_INLINE vd Sqrt(vd x) {
#if GLISSADE_KERNEL_WIDTH == 8
  constexpr int kCurrentRounding = 4;
  return __builtin_ia32_sqrtpd512_mask(x, x, static_cast<char>(0xff), kCurrentRounding);
#elif GLISSADE_KERNEL_WIDTH == 4
  return __builtin_ia32_sqrtpd256(x);
#else
  return __builtin_ia32_sqrtpd(x);
#endif
}

/// Sum of the lanes, pairwise.
GLISSADE_INLINE double Sum(vd v) {
#if GLISSADE_KERNEL_WIDTH == 8
  typedef double v4 __attribute__((vector_size(32)));
  const v4 h = v4{v[0], v[1], v[2], v[3]} + v4{v[4], v[5], v[6], v[7]};
  return (h[0] + h[2]) + (h[1] + h[3]);
#elif GLISSADE_KERNEL_WIDTH == 4
  return (v[0] + v[2]) + (v[1] + v[3]);
#else
  return v[0] + v[1];
#endif
}

/// Lane i: the sum of the lanes of v[i], for kW vectors. Pairwise, as Sum().
GLISSADE_INLINE vd SumEach(const vd* v) {
#if GLISSADE_KERNEL_WIDTH == 8
  vd pairs[4], quads[2];
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    pairs[i] = __builtin_shuffle(v[2 * i], v[2 * i + 1], vi{0, 8, 2, 10, 4, 12, 6, 14}) +
               __builtin_shuffle(v[2 * i], v[2 * i + 1], vi{1, 9, 3, 11, 5, 13, 7, 15});
  }
#pragma GCC unroll 2
  for (int i = 0; i < 2; ++i) {
    quads[i] = __builtin_shuffle(pairs[2 * i], pairs[2 * i + 1], vi{0, 1, 8, 9, 4, 5, 12, 13}) +
               __builtin_shuffle(pairs[2 * i], pairs[2 * i + 1], vi{2, 3, 10, 11, 6, 7, 14, 15});
  }
  return __builtin_shuffle(quads[0], quads[1], vi{0, 1, 2, 3, 8, 9, 10, 11}) +
         __builtin_shuffle(quads[0], quads[1], vi{4, 5, 6, 7, 12, 13, 14, 15});
#elif GLISSADE_KERNEL_WIDTH == 4
  const vd a =
      __builtin_shuffle(v[0], v[1], vi{0, 4, 2, 6}) + __builtin_shuffle(v[0], v[1], vi{1, 5, 3, 7});
  const vd b =
      __builtin_shuffle(v[2], v[3], vi{0, 4, 2, 6}) + __builtin_shuffle(v[2], v[3], vi{1, 5, 3, 7});
  return __builtin_shuffle(a, b, vi{0, 1, 4, 5}) + __builtin_shuffle(a, b, vi{2, 3, 6, 7});
#else
  return __builtin_shuffle(v[0], v[1], vi{0, 2}) + __builtin_shuffle(v[0], v[1], vi{1, 3});
#endif
}

/// Column i of kW columns, ld apart: lane i of w[0], ..., w[5].
GLISSADE_INLINE void StoreSixRows(const vd* w, double* out, Index ld) {
#if GLISSADE_KERNEL_WIDTH == 8
  // Transposed by pairs, quads and halves; what rows 6 and 7 would be is never stored.
  vd p[6], q[4];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    p[2 * i] = __builtin_shuffle(w[2 * i], w[2 * i + 1], vi{0, 8, 2, 10, 4, 12, 6, 14});
    p[2 * i + 1] = __builtin_shuffle(w[2 * i], w[2 * i + 1], vi{1, 9, 3, 11, 5, 13, 7, 15});
  }
#pragma GCC unroll 2
  for (int i = 0; i < 2; ++i) {
    q[i] = __builtin_shuffle(p[i], p[2 + i], vi{0, 1, 8, 9, 4, 5, 12, 13});
    q[2 + i] = __builtin_shuffle(p[i], p[2 + i], vi{2, 3, 10, 11, 6, 7, 14, 15});
  }
  // Lanes 0 and 4 of the columns are in q[0], 1 and 5 in q[1], 2 and 6 in q[2], 3 and 7 in q[3].
  const vd low0 = __builtin_shuffle(q[0], p[4], vi{0, 1, 2, 3, 8, 9, 8, 9});
  const vd low1 = __builtin_shuffle(q[1], p[5], vi{0, 1, 2, 3, 8, 9, 8, 9});
  const vd low2 = __builtin_shuffle(q[2], p[4], vi{0, 1, 2, 3, 10, 11, 10, 11});
  const vd low3 = __builtin_shuffle(q[3], p[5], vi{0, 1, 2, 3, 10, 11, 10, 11});
  const vd high0 = __builtin_shuffle(q[0], p[4], vi{4, 5, 6, 7, 12, 13, 12, 13});
  const vd high1 = __builtin_shuffle(q[1], p[5], vi{4, 5, 6, 7, 12, 13, 12, 13});
  const vd high2 = __builtin_shuffle(q[2], p[4], vi{4, 5, 6, 7, 14, 15, 14, 15});
  const vd high3 = __builtin_shuffle(q[3], p[5], vi{4, 5, 6, 7, 14, 15, 14, 15});
  StorePartial(out, low0, 6);
  StorePartial(out + ld, low1, 6);
  StorePartial(out + 2 * ld, low2, 6);
  StorePartial(out + 3 * ld, low3, 6);
  StorePartial(out + 4 * ld, high0, 6);
  StorePartial(out + 5 * ld, high1, 6);
  StorePartial(out + 6 * ld, high2, 6);
  StorePartial(out + 7 * ld, high3, 6);
#elif GLISSADE_KERNEL_WIDTH == 4
  const vd a0 = __builtin_shuffle(w[0], w[1], vi{0, 4, 2, 6});
  const vd a1 = __builtin_shuffle(w[0], w[1], vi{1, 5, 3, 7});
  const vd b0 = __builtin_shuffle(w[2], w[3], vi{0, 4, 2, 6});
  const vd b1 = __builtin_shuffle(w[2], w[3], vi{1, 5, 3, 7});
  const vd c0 = __builtin_shuffle(w[4], w[5], vi{0, 4, 2, 6});
  const vd c1 = __builtin_shuffle(w[4], w[5], vi{1, 5, 3, 7});
  Store(out, __builtin_shuffle(a0, b0, vi{0, 1, 4, 5}));
  Store(out + ld, __builtin_shuffle(a1, b1, vi{0, 1, 4, 5}));
  Store(out + 2 * ld, __builtin_shuffle(a0, b0, vi{2, 3, 6, 7}));
  Store(out + 3 * ld, __builtin_shuffle(a1, b1, vi{2, 3, 6, 7}));
  StorePartial(out + 4, c0, 2);
  StorePartial(out + ld + 4, c1, 2);
  StorePartial(out + 2 * ld + 4, __builtin_shuffle(c0, c0, vi{2, 3, 2, 3}), 2);
  StorePartial(out + 3 * ld + 4, __builtin_shuffle(c1, c1, vi{2, 3, 2, 3}), 2);
#else
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    Store(out + 2 * i, __builtin_shuffle(w[2 * i], w[2 * i + 1], vi{0, 2}));
    Store(out + ld + 2 * i, __builtin_shuffle(w[2 * i], w[2 * i + 1], vi{1, 3}));
  }
#endif
}

template <typename T>
GLISSADE_INLINE T Min(T a, T b) {
  return a < b ? a : b;
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_SIMD_H_
