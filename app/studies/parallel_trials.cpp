// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/parallel_trials.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "common/interrupt.h"

namespace glissade::app {

ProgressBar::ProgressBar(int total)
    : enabled_(isatty(STDERR_FILENO) != 0), total_(std::max(1, total)) {}

ProgressBar::~ProgressBar() {
  if (enabled_) std::fprintf(stderr, "\r\033[K");
}

void ProgressBar::SetLabel(const std::string& label) {
  label_ = label;
  drawn_percent_ = -1;
  Draw();
}

void ProgressBar::Advance() {
  done_ = std::min(done_ + 1, total_);
  Draw();
}

void ProgressBar::Draw() {
  const int percent = static_cast<int>(100.0 * done_ / total_);
  if (!enabled_ || percent == drawn_percent_) return;
  drawn_percent_ = percent;
  std::string bar(30, '.');
  std::fill_n(bar.begin(), 30 * percent / 100, '#');
  std::fprintf(stderr, "\r[%s] %3d %%  %s\033[K", bar.c_str(), percent, label_.c_str());
  std::fflush(stderr);
}

Status ForEachTrial(int n, int num_threads, ProgressBar* progress,
                    const std::function<Status(int trial)>& f) {
  std::vector<Status> statuses(static_cast<std::size_t>(n));
  std::atomic<int> next{0};
  std::mutex mutex;
  const auto work = [&] {
    for (int trial = next++; trial < n && !Interrupted(); trial = next++) {
      Status& status = statuses[static_cast<std::size_t>(trial)];
      try {
        status = f(trial);
      } catch (const std::exception& error) {  // must not leave its thread
        status = {StatusCode::kEvaluationFailed, error.what()};
      }
      if (progress != nullptr) {
        const std::lock_guard lock(mutex);
        progress->Advance();
      }
    }
  };
  std::vector<std::thread> threads;
  try {
    for (int k = 1; k < std::min(num_threads, n); ++k)
      threads.emplace_back(work);
  } catch (const std::system_error&) {
    // The system gives no more: those that there are do the work.
  }
  work();
  for (std::thread& thread : threads)
    thread.join();
  for (const Status& status : statuses) {
    if (!status.ok()) return status;
  }
  if (Interrupted()) return {StatusCode::kEvaluationFailed, "interrupted"};
  return {};
}

}  // namespace glissade::app
