// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "glissade/base/status.h"

/// \file
/// Normalized estimation error squared (NEES): e' P^-1 e of an error e and the covariance P that
/// the estimator claims for it. Where the claim is right it is chi-square distributed with as many
/// degrees of freedom as e has components (Y. Bar-Shalom, X. Li, T. Kirubarajan, "Estimation with
/// Applications to Tracking and Navigation", 2001, Sec. 5.4).
namespace glissade::eval {

/// e' P^-1 e of n numbers and a symmetric n x n matrix, of which the lower triangle is read (of a
/// row-major one; the upper of a column-major one). By Cholesky of P scaled to a unit diagonal, so
/// that its units do not matter.
///
/// Error and covariance must be in the same tangent, and in a gauge in which the truth has no
/// error: in another one the covariance is another.
///
/// kNotPositive where P is not positive definite, a pivot of the scaled matrix being below n 1e-15,
/// and names the coordinate: an estimator that claims to know a direction perfectly cannot be
/// judged. kNotFinite for NaN or Inf, or where the result overflows; kInvalidArgument where the
/// sizes do not match or are 0.
[[nodiscard]] Result<double> Nees(std::span<const double> error,
                                  std::span<const double> covariance);

/// The same of matrices of Eigen: a vector and a square matrix, expressions too.
template <class Error, class Covariance>
requires requires(const Error& e, const Covariance& P) {
  e.eval().data();
  P.eval().data();
}
[[nodiscard]] Result<double> Nees(const Error& error, const Covariance& covariance) {
  const auto e = error.eval();
  const auto P = covariance.eval();
  if (e.cols() != 1 || P.rows() != P.cols()) {
    return Status(StatusCode::kInvalidArgument, "NEES: a vector and a square matrix are needed");
  }
  return Nees(std::span<const double>(e.data(), static_cast<std::size_t>(e.size())),
              std::span<const double>(P.data(), static_cast<std::size_t>(P.size())));
}

/// Where the mean of M independent NEES of n degrees of freedom lies with a probability, for a
/// consistent estimator: M times the mean is chi-square with M n degrees of freedom.
struct NeesBounds {
  double low = 0.0;
  double high = 0.0;
};

/// The interval with (1 - probability) / 2 on either side. kInvalidArgument unless dof and runs are
/// >= 1, their product fits an int and 0 < probability < 1.
[[nodiscard]] Result<NeesBounds> BoundsOfMeanNees(int dof, int runs, double probability = 0.95);

/// Mean NEES of M independent runs, and its bounds.
struct NeesSummary {
  double mean = 0.0;  ///< dof, for a consistent estimator
  NeesBounds bounds;
  int runs = 0;
  int dof = 0;

  [[nodiscard]] bool Optimistic() const {
    return mean > bounds.high;
  }  ///< covariances are too small
  [[nodiscard]] bool Pessimistic() const { return mean < bounds.low; }  ///< too large
  [[nodiscard]] bool Consistent() const { return !Optimistic() && !Pessimistic(); }
};

/// Of the NEES of each run. Errors of one run at different times are not independent: give one
/// value a run. Refused: what BoundsOfMeanNees refuses; kNotFinite.
[[nodiscard]] Result<NeesSummary> SummarizeNees(std::span<const double> nees_of_runs, int dof,
                                                double probability = 0.95);

}  // namespace glissade::eval
