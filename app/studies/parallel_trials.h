// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "glissade/base/status.h"

namespace glissade::app {

/// A line on a terminal that says how far the work is: "[######....]  60 %  sine plane". Nothing is
/// printed where stderr is not a terminal.
class ProgressBar {
 public:
  explicit ProgressBar(int total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void SetLabel(const std::string& label);
  /// Not thread-safe: ForEachTrial serializes.
  void Advance();

 private:
  void Draw();
  bool enabled_ = false;
  int total_ = 1;
  int done_ = 0;
  int drawn_percent_ = -1;
  std::string label_;
};

/// Calls f(trial) for each trial in [0, n) on num_threads threads and returns the failure of the
/// lowest trial, if any. Results must go to places that belong to their trial: then nothing depends
/// on the threads. Interrupted, no further trial is begun, and that is a failure. `progress` may be
/// null.
Status ForEachTrial(int n, int num_threads, ProgressBar* progress,
                    const std::function<Status(int trial)>& f);

}  // namespace glissade::app
