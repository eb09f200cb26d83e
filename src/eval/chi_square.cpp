// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/chi_square.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace glissade::eval {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// ln Gamma(a + 1) - (a ln a - a + ln(2 pi a) / 2), for a a multiple of 1/2.
double StirlingError(double a) {
  if (a < 15.5) {
    // Gamma(a + 1) = a (a - 1) ..., down to Gamma(1) or Gamma(1/2).
    double gamma = a == std::floor(a) ? 1.0 : std::sqrt(std::numbers::pi);
    for (double k = a; k > 0.0; k -= 1.0)
      gamma *= k;
    return std::log(gamma) - a * std::log(a) + a - 0.5 * std::log(2.0 * std::numbers::pi * a);
  }
  const double s = 1.0 / (a * a);
  return (1.0 / 12 -
          s * (1.0 / 360 -
               s * (1.0 / 1260 - s * (1.0 / 1680 - s * (1.0 / 1188 - s * 691 / 360360))))) /
         a;
}

/// a ln(a / x) + x - a, without cancellation where x is near a.
double Deviance(double a, double x) {
  const double v = (x - a) / (x + a);
  if (std::abs(v) >= 0.1) return a * std::log(a / x) + x - a;
  double sum = (x - a) * v, term = 2.0 * a * v;
  for (int k = 1; k < 100; ++k) {
    term *= v * v;
    const double next = sum - term / (2 * k + 1);
    if (next == sum) break;
    sum = next;
  }
  return sum;
}

/// ln(x^a e^-x / Gamma(a + 1)).
double LogFactor(double a, double x) {
  return -StirlingError(a) - Deviance(a, x) - 0.5 * std::log(2.0 * std::numbers::pi * a);
}

/// 1 + x / (a + 1) + x^2 / ((a + 1)(a + 2)) + ...: P over the factor. For x < a + 1.
double LowerSeries(double a, double x) {
  double sum = 1.0, term = 1.0;
  for (double k = a + 1.0; term > 0.25 * kEpsilon * sum; k += 1.0) {
    term *= x / k;
    sum += term;
  }
  return sum;
}

/// Q over the factor: a times Legendre's continued fraction 1 / (x + 1 - a - (1 - a) / (x + 3 - a -
/// ...)), by Lentz' method. For x >= a + 1.
double UpperFraction(double a, double x) {
  constexpr double kTiny = 1e-300;
  double b = x + 1.0 - a;
  double c = 1.0 / kTiny, d = 1.0 / b, h = d;
  for (double k = 1.0;; k += 1.0) {
    const double numerator = -k * (k - a);
    b += 2.0;
    d = numerator * d + b;
    if (std::abs(d) < kTiny) d = kTiny;
    c = b + numerator / c;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1.0 / d;
    const double factor = d * c;
    h *= factor;
    // Not to the last bit: rounding may keep the factor from being 1 for ever.
    if (!(std::abs(factor - 1.0) > 2.0 * kEpsilon) || k > 1e7) return a * h;
  }
}

/// ln P(X <= x) and ln P(X > x) for x > 0.
struct LogTails {
  double lower = -kInfinity;
  double upper = -kInfinity;
};

LogTails LogTailsAt(double chi_square, int dof) {
  const double a = 0.5 * dof, x = 0.5 * chi_square;
  if (!(x < kInfinity)) return {0.0, -kInfinity};
  const double log_factor = LogFactor(a, x);
  LogTails log;
  if (x < a + 1.0) {
    log.lower = std::min(log_factor + std::log(LowerSeries(a, x)), 0.0);
    log.upper = std::log1p(-std::exp(log.lower));
  } else {
    log.upper = std::min(log_factor + std::log(UpperFraction(a, x)), 0.0);
    log.lower = std::log1p(-std::exp(log.upper));
  }
  return log;
}

/// Wilson and Hilferty (1931): the cube root is nearly normal. A start, good to a few percent.
double WilsonHilferty(double log_lower, double log_upper, int dof) {
  // Normal quantile of the smaller tail (Abramowitz and Stegun, 26.2.23), error below 5e-4.
  const double t = std::sqrt(-2.0 * std::min(log_lower, log_upper));
  double z = t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                     (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  if (log_lower < log_upper) z = -z;
  const double v = 2.0 / (9.0 * dof);
  const double root = 1.0 - v + z * std::sqrt(v);
  return dof * root * root * root;
}

}  // namespace

double ChiSquareCdf(double x, int dof) {
  if (dof < 1 || std::isnan(x)) return std::numeric_limits<double>::quiet_NaN();
  return x > 0.0 ? std::exp(LogTailsAt(x, dof).lower) : 0.0;
}

double ChiSquareTail(double x, int dof) {
  if (dof < 1 || std::isnan(x)) return std::numeric_limits<double>::quiet_NaN();
  return x > 0.0 ? std::exp(LogTailsAt(x, dof).upper) : 1.0;
}

Result<double> ChiSquareQuantile(double probability, int dof) {
  if (dof < 1 || !(probability > 0.0 && probability < 1.0)) {
    return Status(StatusCode::kInvalidArgument,
                  "chi-square quantile: dof must be >= 1 and the probability between 0 and 1");
  }
  // The logarithm of the smaller tail over ln x is concave, so that Newton's method comes from one
  // side; a bracket keeps it from what rounding and a poor start may do.
  const bool lower = probability <= 0.5;
  const double log_p = std::log(probability), log_q = std::log1p(-probability);
  const double a = 0.5 * dof;
  double y = std::log(std::max(WilsonHilferty(log_p, log_q, dof), 1e-300));
  // P is at most the factor times e^x, and near x = 0 just the factor: a start where the cube root
  // has none.
  if (lower) y = std::max(y, std::log(2.0) + (log_p - LogFactor(a, 1.0) - 1.0) / a);
  double low = -740.0, high = std::log(static_cast<double>(dof)) + 10.0;
  y = std::clamp(y, low, high);
  // How far ln x is too large, by Newton's method at x.
  const auto newton = [&](double x, double* error) {
    const LogTails log = LogTailsAt(x, dof);
    *error = lower ? log.lower - log_p : log_q - log.upper;  // rises with x
    // d P / d ln x is a times the factor; of the logarithm of a tail, over the tail.
    return *error / (a * std::exp(LogFactor(a, 0.5 * x) - (lower ? log.lower : log.upper)));
  };
  double error = 0.0;
  for (int iteration = 0; iteration < 200; ++iteration) {
    double next = y - newton(std::exp(y), &error);
    (error > 0.0 ? high : low) = y;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double step = std::abs(next - y);
    y = next;
    if (step <= 2.0 * kEpsilon * std::max(1.0, std::abs(y))) break;
  }
  // The last digits, which the logarithm of a large number does not hold.
  const double x = std::exp(y);
  const double step = newton(x, &error);
  return std::abs(step) < 1e-6 ? x - x * step : x;
}

}  // namespace glissade::eval
