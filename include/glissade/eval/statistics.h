// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace glissade::eval {

/// Of errors that are not negative, in their unit; all 0 where there are none.
struct Statistics {
  double rmse = 0.0;  ///< sqrt(1/n sum e^2)
  double mean = 0.0;
  double median = 0.0;  ///< of an even number of errors the mean of the middle two
  double max = 0.0;
  std::size_t count = 0;
};

[[nodiscard]] Statistics StatisticsOf(std::span<const double> errors);

/// The p-th part of the sorted values, 0 <= p <= 1, interpolated between neighbours; 0 where there
/// are none.
[[nodiscard]] double Quantile(std::vector<double> values, double p);

}  // namespace glissade::eval
