// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace glissade::test {

/// Calls of malloc and its relatives in this program so far; -1 where they cannot be counted (under
/// sanitizers, which replace malloc themselves, and with C libraries other than glibc).
std::int64_t MallocCount();

/// While it lives, malloc and its relatives fail: for the allocation with this number (0: the next)
/// or, `on`, for that and all later ones.
class FailingMalloc {
 public:
  explicit FailingMalloc(std::int64_t number, bool on = false);
  ~FailingMalloc();
  FailingMalloc(const FailingMalloc&) = delete;
  FailingMalloc& operator=(const FailingMalloc&) = delete;
  /// Whether an allocation has failed.
  [[nodiscard]] bool failed() const;

 private:
  std::int64_t number_;  // in all of the program's allocations
};

/// Bytes on the heap now, and the most there have been since ResetPeakHeap(); -1 where they cannot
/// be counted.
std::int64_t HeapBytes();
std::int64_t PeakHeapBytes();
void ResetPeakHeap();

}  // namespace glissade::test
