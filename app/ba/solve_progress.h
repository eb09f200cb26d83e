// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "glissade/minimizer/options.h"

namespace glissade::app {

/// How far a solve is: "iteration 7 of at most 50, cost 1.234567e+05, 34 s, about 20 s left".
///
/// The time left is that of the iterations until the decrease of the cost comes under the
/// tolerance, if it goes on shrinking as it did between the last two; where it does not shrink, at
/// most that of all iterations allowed; "?" before the first.
class SolveProgress {
 public:
  explicit SolveProgress(const SolveOptions& options) : options_(options) {}

  std::string After(const IterationSummary& iteration);

 private:
  [[nodiscard]] std::string TimeLeft(const IterationSummary& iteration);

  const SolveOptions options_;
  double decrease_before_ = 0.0;  // relative, of the last accepted step
};

/// "34 s", "12 min", "3.5 h".
std::string Duration(double seconds);

}  // namespace glissade::app
