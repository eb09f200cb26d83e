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
  std::vector<double> sorted(errors.begin(), errors.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  s.median = *middle;
  if (sorted.size() % 2 == 0) {
    s.median = 0.5 * (s.median + *std::max_element(sorted.begin(), middle));
  }
  return s;
}

}  // namespace glissade::eval
