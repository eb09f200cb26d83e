// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstring>

/// \file
/// Pack: several doubles in one register, with the operators of a double. An edge whose Evaluate is
/// a template over its scalar type is evaluated for as many edges at once as a register of the unit
/// that adds it has room for.
namespace glissade {

namespace internal {
// Each translation unit has a type of its own, so that units compiled for different instruction
// sets never share a copy of what is made from packs: the linker would keep one for all of them.
namespace {
struct ThisUnit {};
}  // namespace

/// Set where a condition was not the same in all lanes of a pack.
template <class Unit>
inline thread_local bool pack_diverged = false;
}  // namespace internal

#if defined(__AVX512F__)
#define GLISSADE_PACK_WIDTH 8
#elif defined(__AVX__)
#define GLISSADE_PACK_WIDTH 4
#else
#define GLISSADE_PACK_WIDTH 2
#endif

/// Doubles in a register of this unit.
inline constexpr int kPackWidth = GLISSADE_PACK_WIDTH;

namespace internal {
typedef double PackRegister __attribute__((vector_size(8 * GLISSADE_PACK_WIDTH)));
typedef long long PackMaskRegister __attribute__((vector_size(8 * GLISSADE_PACK_WIDTH)));
}  // namespace internal

template <class Unit = internal::ThisUnit>
struct PackMask;

template <class Unit = internal::ThisUnit>
struct Pack {
  static constexpr int kWidth = kPackWidth;
  using Register = internal::PackRegister;
  Register v;

  Pack() = default;
  Pack(double x) : v(x - Register{}) {}          // NOLINT: implicit, as for a double
  Pack(int x) : Pack(static_cast<double>(x)) {}  // NOLINT
  explicit Pack(const Register& x) : v(x) {}

  static Pack Load(const double* x) {
    Pack pack;
    std::memcpy(&pack.v, x, sizeof(pack.v));
    return pack;
  }
  void Store(double* x) const { std::memcpy(x, &v, sizeof(v)); }
  [[nodiscard]] double Lane(int i) const { return v[i]; }
  /// Lane i is f(i).
  template <class F>
  static Pack Of(F f) {
#if GLISSADE_PACK_WIDTH == 8
    return Pack(Register{f(0), f(1), f(2), f(3), f(4), f(5), f(6), f(7)});
#elif GLISSADE_PACK_WIDTH == 4
    return Pack(Register{f(0), f(1), f(2), f(3)});
#else
    return Pack(Register{f(0), f(1)});
#endif
  }

  Pack& operator+=(const Pack& b) {
    return v += b.v, *this;
  }
  Pack& operator-=(const Pack& b) {
    return v -= b.v, *this;
  }
  Pack& operator*=(const Pack& b) {
    return v *= b.v, *this;
  }
  Pack& operator/=(const Pack& b) {
    return v /= b.v, *this;
  }
  friend Pack operator+(const Pack& a, const Pack& b) {
    return Pack(a.v + b.v);
  }
  friend Pack operator-(const Pack& a, const Pack& b) {
    return Pack(a.v - b.v);
  }
  friend Pack operator*(const Pack& a, const Pack& b) {
    return Pack(a.v * b.v);
  }
  friend Pack operator/(const Pack& a, const Pack& b) {
    return Pack(a.v / b.v);
  }
  friend Pack operator-(const Pack& a) {
    return Pack(-a.v);
  }

  using Mask = PackMask<Unit>;
  friend Mask operator<(const Pack& a, const Pack& b) {
    return {a.v < b.v};
  }
  friend Mask operator>(const Pack& a, const Pack& b) {
    return {a.v > b.v};
  }
  friend Mask operator<=(const Pack& a, const Pack& b) {
    return {a.v <= b.v};
  }
  friend Mask operator>=(const Pack& a, const Pack& b) {
    return {a.v >= b.v};
  }
  friend Mask operator==(const Pack& a, const Pack& b) {
    return {a.v == b.v};
  }
  friend Mask operator!=(const Pack& a, const Pack& b) {
    return {a.v != b.v};
  }

  /// Where the mask is true a, else b.
  friend Pack Select(const Mask& mask, const Pack& a, const Pack& b) {
    return Pack(mask.m ? a.v : b.v);
  }
  friend Pack sqrt(const Pack& a) {
    return a.Map([](double x) { return std::sqrt(x); });
  }
  friend Pack sin(const Pack& a) {
    return a.Map([](double x) { return std::sin(x); });
  }
  friend Pack cos(const Pack& a) {
    return a.Map([](double x) { return std::cos(x); });
  }
  friend Pack tan(const Pack& a) {
    return a.Map([](double x) { return std::tan(x); });
  }
  friend Pack atan(const Pack& a) {
    return a.Map([](double x) { return std::atan(x); });
  }
  friend Pack exp(const Pack& a) {
    return a.Map([](double x) { return std::exp(x); });
  }
  friend Pack log(const Pack& a) {
    return a.Map([](double x) { return std::log(x); });
  }
  friend Pack atan2(const Pack& y, const Pack& x) {
    return Of([&](int i) { return std::atan2(y.v[i], x.v[i]); });
  }
  friend Pack abs(const Pack& a) {
    return Select(a < Pack(0.0), -a, a);
  }

 private:
  template <class F>
  [[nodiscard]] Pack Map(F f) const {
    return Of([&](int i) { return f(v[i]); });
  }
};

/// What comparing packs gives. As a condition it is that of the first lane; where another lane has
/// it otherwise, the library evaluates the edges of the pack once more, one by one.
template <class Unit>
struct PackMask {
  internal::PackMaskRegister m;

  explicit operator bool() const {
    const int lanes = Lanes();
    if (lanes != 0 && lanes != (1 << kPackWidth) - 1) internal::pack_diverged<Unit> = true;
    return (lanes & 1) != 0;
  }
  friend PackMask operator&(const PackMask& a, const PackMask& b) { return {a.m & b.m}; }
  friend PackMask operator|(const PackMask& a, const PackMask& b) { return {a.m | b.m}; }
  friend PackMask operator!(const PackMask& a) { return {~a.m}; }

 private:
  /// One bit a lane.
  [[nodiscard]] int Lanes() const {
#if defined(__AVX512DQ__) && !defined(__clang__)
    return static_cast<int>(__builtin_ia32_cvtq2mask512(m));
#elif GLISSADE_PACK_WIDTH == 4 && !defined(__clang__)
    return __builtin_ia32_movmskpd256(reinterpret_cast<internal::PackRegister>(m));
#elif defined(__SSE2__) && GLISSADE_PACK_WIDTH == 2 && !defined(__clang__)
    return __builtin_ia32_movmskpd(reinterpret_cast<internal::PackRegister>(m));
#else
    int lanes = 0;
    for (int i = 0; i < kPackWidth; ++i)
      lanes |= static_cast<int>(m[i] & 1) << i;
    return lanes;
#endif
  }
};

/// The same for a double.
inline double Select(bool condition, double a, double b) {
  return condition ? a : b;
}

}  // namespace glissade
