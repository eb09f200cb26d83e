// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/eval/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace glissade::eval {

Statistics StatisticsOf(std::span<const double> errors) {
  Statistics s;
  s.count = errors.size();
  if (errors.empty()) return s;
  double sum = 0.0, squares = 0.0;
  for (const double e : errors) {
    sum += e;
    squares += e * e;
    s.max = std::max(s.max, e);
  }
  const auto n = static_cast<double>(errors.size());
  s.mean = sum / n;
  s.rmse = std::sqrt(squares / n);
  s.median = Quantile({errors.begin(), errors.end()}, 0.5);
  return s;
}

double Quantile(std::vector<double> values, double p) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double at = p * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

}  // namespace glissade::eval
