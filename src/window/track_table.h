// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace glissade::internal {

/// From a front end's track numbers to positions in a list. Open addressing in one array, so that a
/// window that is full allocates nothing when tracks come and go.
class TrackTable {
 public:
  TrackTable() : slots_(64) {}

  /// -1: not there.
  [[nodiscard]] int Find(std::int64_t track) const {
    for (std::size_t i = Home(track);; i = Next(i)) {
      if (slots_[i].value < 0) return -1;
      if (slots_[i].track == track) return slots_[i].value;
    }
  }
  /// value >= 0; replaces what was there.
  void Set(std::int64_t track, int value);
  void Erase(std::int64_t track);
  void Clear();

 private:
  struct Slot {
    std::int64_t track = 0;
    int value = -1;  // -1: empty
  };
  [[nodiscard]] std::size_t Home(std::int64_t track) const {
    // Fibonacci hashing: neighbouring numbers, as front ends give them, lie far apart.
    return static_cast<std::size_t>((static_cast<std::uint64_t>(track) * 0x9e3779b97f4a7c15u) >>
                                    32) &
           (slots_.size() - 1);
  }
  [[nodiscard]] std::size_t Next(std::size_t i) const { return (i + 1) & (slots_.size() - 1); }
  void Grow();

  std::vector<Slot> slots_;  // a power of two, at most half full
  std::size_t used_ = 0;
};

}  // namespace glissade::internal
