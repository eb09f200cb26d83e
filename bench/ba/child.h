// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <functional>
#include <string>

namespace glissade::bench {

struct ChildLimits {
  double seconds = 0.0;    ///< wall clock; then it is killed. 0: none
  double memory_mb = 0.0;  ///< of its address space. 0: none
};

/// Runs `work` in a process of its own, which has nothing in memory but this small program, and
/// hands each line that it writes to `on_line`. What may go wrong there, goes wrong there: returns
/// "done", or "time limit", "out of memory", "signal 11 (Segmentation fault)", "exit code 1".
std::string RunInChild(const std::function<void(std::FILE*)>& work, const ChildLimits& limits,
                       const std::function<void(const std::string&)>& on_line);

}  // namespace glissade::bench
