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

/// LoadPartial with the count known to the compiler.
template <int kCount>
GLISSADE_INLINE vd LoadFirst(const double* p) {
#if GLISSADE_KERNEL_WIDTH == 4
  if (kCount == 1) return vd{p[0], 0.0, 0.0, 0.0};
  if (kCount == 2) return vd{p[0], p[1], 0.0, 0.0};
#endif
  return kCount == kW ? Load(p) : LoadPartial(p, kCount);
}

template <int kCount>
GLISSADE_INLINE void StoreFirst(double* p, vd v) {
  if (kCount == kW) {
    Store(p, v);
  } else {
    StorePartial(p, v, kCount);
  }
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

template <typename T>
GLISSADE_INLINE T Min(T a, T b) {
  return a < b ? a : b;
}
template <typename T>
GLISSADE_INLINE T Max(T a, T b) {
  return a > b ? a : b;
}

}  // namespace
}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_IMPL_SIMD_H_
