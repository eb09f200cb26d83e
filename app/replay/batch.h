// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "replay/causal_run.h"

namespace glissade::app {

struct BatchSolution {
  eval::Trajectory trajectory;  ///< at the frames that the causal run has
  int points = 0, observations = 0, left_out = 0, imu_terms = 0;
  int iterations = 0;
  double final_cost = 0.0, time_s = 0.0;
};

/// All that was measured as one problem: what a window can approach and not beat. Begins at the
/// causal run's states; its points are triangulated from them, without the observations that the
/// window took out, and views that do not fit at all. Solved with a robust loss, then again with
/// points triangulated anew and without what is beyond 99.9 % of chi2. Speed and biases are free,
/// as nobody knows them beforehand.
Result<BatchSolution> SolveBatch(const Viotracks& recording, const ReplaySettings& settings,
                                 const CausalRun& causal);

}  // namespace glissade::app
