// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/nees.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "glissade/base/out_of_memory.h"
#include "glissade/base/validate.h"
#include "glissade/eval/chi_square.h"

namespace glissade::eval {

namespace {

Status NotPositiveAt(std::size_t i) {
  return {StatusCode::kNotPositive,
          std::string("NEES: the covariance is not positive definite at coordinate ")
              .append(std::to_string(i))};
}

Result<double> Compute(std::span<const double> error, std::span<const double> covariance) {
  const std::size_t n = error.size();
  std::vector<double> scale(n), L(n * n), y(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double variance = covariance[i * n + i];
    if (!(variance > 0.0)) return NotPositiveAt(i);
    scale[i] = 1.0 / std::sqrt(variance);
  }
  const double least = 1e-15 * static_cast<double>(n);
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    double left = error[i] * scale[i];
    for (std::size_t j = 0; j < i; ++j) {
      double x = covariance[i * n + j] * scale[i] * scale[j];
      for (std::size_t k = 0; k < j; ++k)
        x -= L[i * n + k] * L[j * n + k];
      L[i * n + j] = x / L[j * n + j];
      left -= L[i * n + j] * y[j];
    }
    double pivot = 1.0;
    for (std::size_t k = 0; k < i; ++k)
      pivot -= L[i * n + k] * L[i * n + k];
    if (!(pivot > least)) return NotPositiveAt(i);
    L[i * n + i] = std::sqrt(pivot);
    y[i] = left / L[i * n + i];
    sum += y[i] * y[i];
  }
  if (!std::isfinite(sum)) return Status(StatusCode::kNotFinite, "NEES: the result overflows");
  return sum;
}

}  // namespace

Result<double> Nees(std::span<const double> error, std::span<const double> covariance) {
  const std::size_t n = error.size();
  if (n == 0 || n > 100000 || covariance.size() != n * n) {
    return Status(StatusCode::kInvalidArgument,
                  "NEES: needs n numbers and a covariance of n x n, n > 0");
  }
  const auto check = [](std::span<const double> x, const char* what) {
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (!std::isfinite(x[k])) return ValidateFinite(&x[k], 1, what);
    }
    return Status();
  };
  if (Status s = check(error, "NEES: error"); !s.ok()) return s;
  if (Status s = check(covariance, "NEES: covariance"); !s.ok()) return s;
  return glissade::internal::OrOutOfMemory([&] { return Compute(error, covariance); });
}

Result<NeesBounds> BoundsOfMeanNees(int dof, int runs, double probability) {
  if (dof < 1 || runs < 1 || runs > std::numeric_limits<int>::max() / dof) {
    return Status(StatusCode::kInvalidArgument,
                  "NEES: dof and runs must be >= 1 and their product an int");
  }
  if (!(probability > 0.0 && probability < 1.0)) {
    return Status(StatusCode::kInvalidArgument, "NEES: the probability must be between 0 and 1");
  }
  const auto low = ChiSquareQuantile(0.5 * (1.0 - probability), dof * runs);
  if (!low.ok()) return low.status();
  const auto high = ChiSquareQuantile(0.5 * (1.0 + probability), dof * runs);
  if (!high.ok()) return high.status();
  return NeesBounds{*low / runs, *high / runs};
}

Result<NeesSummary> SummarizeNees(std::span<const double> nees_of_runs, int dof,
                                  double probability) {
  NeesSummary summary;
  summary.dof = dof;
  summary.runs =
      static_cast<int>(std::min<std::size_t>(nees_of_runs.size(), std::numeric_limits<int>::max()));
  const auto bounds = BoundsOfMeanNees(dof, summary.runs, probability);
  if (!bounds.ok()) return bounds.status();
  summary.bounds = *bounds;
  for (const double nees : nees_of_runs)
    summary.mean += nees / static_cast<double>(nees_of_runs.size());
  if (!std::isfinite(summary.mean)) {
    return Status(StatusCode::kNotFinite, "NEES: one of the runs, or their sum, is not finite");
  }
  return summary;
}

}  // namespace glissade::eval
