// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>

#include "errors.h"
#include "glissade/window/sliding_window.h"
#include "unlocked.h"

namespace glissade::python {

namespace nb = nanobind;

/// As PyProblem: no two threads at once. Calls that work do so without the
/// interpreter's lock.
class PyWindow {
 public:
  explicit PyWindow(const SlidingWindowOptions& options)
      : window_(options), has_imu_(options.imu_noise.has_value()) {
    Check(options.Validate());
  }
  SlidingWindow& get() {
    if (busy_) {
      throw nb::builtin_exception(nb::exception_type::runtime_error,
                                  "another thread is working on this window");
    }
    return window_;
  }
  [[nodiscard]] bool has_imu() const { return has_imu_; }
  template <class F>
  auto Work(F&& f) {
    SlidingWindow& window = get();
    busy_ = true;
    struct Done {
      std::atomic<bool>& busy;
      ~Done() { busy = false; }
    } done{busy_};
    const Unlocked unlocked;
    return f(window);
  }

 private:
  SlidingWindow window_;
  bool has_imu_;
  std::atomic<bool> busy_ = false;
};

void BindViotracks(nb::module_& m);

}  // namespace glissade::python
