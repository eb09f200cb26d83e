// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <type_traits>

#include "glissade/base/pack.h"

namespace glissade {

/// A number with its derivatives along N directions: a scalar for templates, of which the library
/// makes the Jacobians of an edge that does not write them. T: double or Pack.
template <class T, int N>
struct Dual {
  T a;     ///< value
  T d[N];  ///< derivatives

  Dual() = default;
  Dual(const T& value) : a(value) {  // NOLINT: implicit, a constant
    for (T& x : d)
      x = T(0.0);
  }
  template <class Number>
  requires(std::is_arithmetic_v<Number> && !std::is_same_v<Number, T>) Dual(Number value)  // NOLINT
      : Dual(T(static_cast<double>(value))) {}

  Dual& operator+=(const Dual& y) { return *this = *this + y; }
  Dual& operator-=(const Dual& y) { return *this = *this - y; }
  Dual& operator*=(const Dual& y) { return *this = *this * y; }
  Dual& operator/=(const Dual& y) { return *this = *this / y; }

  friend Dual operator+(const Dual& x, const Dual& y) {
    return Make(x.a + y.a, [&](int k) { return x.d[k] + y.d[k]; });
  }
  friend Dual operator-(const Dual& x, const Dual& y) {
    return Make(x.a - y.a, [&](int k) { return x.d[k] - y.d[k]; });
  }
  friend Dual operator-(const Dual& x) {
    return Make(-x.a, [&](int k) { return -x.d[k]; });
  }
  friend Dual operator*(const Dual& x, const Dual& y) {
    return Make(x.a * y.a, [&](int k) { return x.d[k] * y.a + x.a * y.d[k]; });
  }
  friend Dual operator/(const Dual& x, const Dual& y) {
    const T inverse = T(1.0) / y.a, quotient = x.a * inverse;
    return Make(quotient, [&](int k) { return (x.d[k] - quotient * y.d[k]) * inverse; });
  }

  // Of the values; a pack's, where T is one.
  friend auto operator<(const Dual& x, const Dual& y) { return x.a < y.a; }
  friend auto operator>(const Dual& x, const Dual& y) { return x.a > y.a; }
  friend auto operator<=(const Dual& x, const Dual& y) { return x.a <= y.a; }
  friend auto operator>=(const Dual& x, const Dual& y) { return x.a >= y.a; }
  friend auto operator==(const Dual& x, const Dual& y) { return x.a == y.a; }
  friend auto operator!=(const Dual& x, const Dual& y) { return x.a != y.a; }

  template <class Mask>
  friend Dual Select(const Mask& mask, const Dual& x, const Dual& y) {
    return Make(Select(mask, x.a, y.a), [&](int k) { return Select(mask, x.d[k], y.d[k]); });
  }
  friend Dual sqrt(const Dual& x) {
    using std::sqrt;
    const T root = sqrt(x.a);
    return Chain(x, root, T(0.5) / root);
  }
  friend Dual sin(const Dual& x) {
    using std::cos;
    using std::sin;
    return Chain(x, sin(x.a), cos(x.a));
  }
  friend Dual cos(const Dual& x) {
    using std::cos;
    using std::sin;
    return Chain(x, cos(x.a), -sin(x.a));
  }
  friend Dual tan(const Dual& x) {
    using std::tan;
    const T t = tan(x.a);
    return Chain(x, t, T(1.0) + t * t);
  }
  friend Dual atan(const Dual& x) {
    using std::atan;
    return Chain(x, atan(x.a), T(1.0) / (T(1.0) + x.a * x.a));
  }
  friend Dual exp(const Dual& x) {
    using std::exp;
    const T e = exp(x.a);
    return Chain(x, e, e);
  }
  friend Dual log(const Dual& x) {
    using std::log;
    return Chain(x, log(x.a), T(1.0) / x.a);
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    using std::atan2;
    const T inverse = T(1.0) / (x.a * x.a + y.a * y.a);
    return Make(atan2(y.a, x.a), [&](int k) { return (x.a * y.d[k] - y.a * x.d[k]) * inverse; });
  }
  friend Dual abs(const Dual& x) { return Select(x < Dual(0.0), -x, x); }

 private:
  template <class F>
  static Dual Make(const T& value, F&& derivative) {
    Dual out;
    out.a = value;
    for (int k = 0; k < N; ++k)
      out.d[k] = derivative(k);
    return out;
  }
  static Dual Chain(const Dual& x, const T& value, const T& slope) {
    return Make(value, [&](int k) { return slope * x.d[k]; });
  }
};

}  // namespace glissade
