// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/random.h"

#include <cmath>

namespace glissade::sim {

namespace {

constexpr std::uint64_t kModulus = 2147483647;  // 2^31 - 1

/// a * b, rounded to double. Never fused with an addition, whatever the compiler is told about
/// contraction: that would change the last bit.
double Product(double a, double b) {
  volatile double product = a * b;
  return product;
}

/// An unevaluated sum hi + lo with |lo| <= ulp(hi) / 2: about 106 bits.
struct DoubleDouble {
  double hi;
  double lo;
};

/// a + b exactly (Knuth).
DoubleDouble TwoSum(double a, double b) {
  const double sum = a + b;
  const double bb = sum - a;
  return {sum, (a - (sum - bb)) + (b - bb)};
}

/// a * b exactly (Dekker). The four partial products are exact, so fusing them changes nothing.
DoubleDouble TwoProduct(double a, double b) {
  constexpr double kSplit = 134217729.0;  // 2^27 + 1
  const double ca = Product(kSplit, a);
  const double cb = Product(kSplit, b);
  const double a_hi = ca - (ca - a);
  const double b_hi = cb - (cb - b);
  const double a_lo = a - a_hi;
  const double b_lo = b - b_hi;
  const double p = Product(a, b);
  return {p, ((a_hi * b_hi - p) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo};
}

DoubleDouble Add(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble s = TwoSum(a.hi, b.hi);
  const DoubleDouble t = TwoSum(a.lo, b.lo);
  const DoubleDouble u = TwoSum(s.hi, s.lo + t.hi);
  return TwoSum(u.hi, u.lo + t.lo);
}

DoubleDouble Multiply(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble p = TwoProduct(a.hi, b.hi);
  return TwoSum(p.hi, p.lo + (Product(a.hi, b.lo) + Product(a.lo, b.hi)));
}

DoubleDouble Divide(const DoubleDouble& a, const DoubleDouble& b) {
  // Long division, three digits of 53 bits.
  DoubleDouble quotient{0.0, 0.0};
  DoubleDouble rest = a;
  for (int digit = 0; digit < 3; ++digit) {
    const DoubleDouble q{rest.hi / b.hi, 0.0};
    quotient = Add(quotient, q);
    const DoubleDouble qb = Multiply(q, b);
    rest = Add(rest, {-qb.hi, -qb.lo});
  }
  return quotient;
}

}  // namespace

double CorrectlyRoundedLog(double x) {
  // x = m 2^e with m in [sqrt(1/2), sqrt(2)): no cancellation between the two parts of
  // log x = e log 2 + 2 atanh(s), s = (m - 1) / (m + 1), |s| < 0.1716.
  int e = 0;
  double m = std::frexp(x, &e);
  if (m < 0.70710678118654757) {
    m = 2.0 * m;
    --e;
  }
  const DoubleDouble s = Divide(TwoSum(m, -1.0), TwoSum(m, 1.0));
  const DoubleDouble s2 = Multiply(s, s);
  // sum of s^(2k) / (2k + 1): 0.1716^44 < 2^-106.
  DoubleDouble sum{0.0, 0.0};
  for (int k = 22; k >= 0; --k) {
    const DoubleDouble term = Divide({1.0, 0.0}, {2.0 * k + 1.0, 0.0});
    sum = Add(Multiply(sum, s2), term);
  }
  DoubleDouble log_m = Multiply(s, sum);
  log_m = {2.0 * log_m.hi, 2.0 * log_m.lo};
  constexpr DoubleDouble kLog2{0.69314718055994529, 2.3190468138462996e-17};
  const DoubleDouble log_x = Add(Multiply({static_cast<double>(e), 0.0}, kLog2), log_m);
  return log_x.hi + log_x.lo;
}

MinstdRand0::MinstdRand0(std::uint32_t seed) : state_(static_cast<std::uint32_t>(seed % kModulus)) {
  if (state_ == 0) state_ = 1;
}

std::uint32_t MinstdRand0::Next() {
  state_ = static_cast<std::uint32_t>(16807 * std::uint64_t{state_} % kModulus);
  return state_;
}

double MinstdRand0::NextCanonical() {
  constexpr double kRange = static_cast<double>(kMax - kMin) + 1.0;
  // The number of pairs is not a power of two and is rounded to double, as libstdc++ does.
  constexpr double kPairs = static_cast<double>(std::uint64_t{kMax} * std::uint64_t{kMax});
  const double low = static_cast<double>(Next() - kMin);
  const double high = static_cast<double>(Next() - kMin);
  const double x = (low + Product(high, kRange)) / kPairs;
  return x < 1.0 ? x : 1.0 - 0x1p-53;
}

double UniformReal(MinstdRand0& engine, double low, double high) {
  return Product(engine.NextCanonical(), high - low) + low;
}

double NormalReal::operator()(MinstdRand0& engine) {
  double x = saved_;
  if (has_saved_) {
    has_saved_ = false;
  } else {
    double u = 0.0, v = 0.0, r2 = 0.0;
    do {
      u = 2.0 * engine.NextCanonical() - 1.0;
      v = 2.0 * engine.NextCanonical() - 1.0;
      r2 = Product(u, u) + Product(v, v);
    } while (r2 > 1.0 || r2 == 0.0);
    const double scale = std::sqrt(-2.0 * CorrectlyRoundedLog(r2) / r2);
    saved_ = Product(u, scale);
    has_saved_ = true;
    x = Product(v, scale);
  }
  return Product(x, sigma_) + mean_;
}

}  // namespace glissade::sim
