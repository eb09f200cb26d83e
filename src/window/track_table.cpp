// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/track_table.h"

#include <algorithm>

namespace glissade::internal {

void TrackTable::Set(std::int64_t track, int value) {
  if (2 * (used_ + 1) > slots_.size()) Grow();
  std::size_t i = Home(track);
  while (slots_[i].value >= 0 && slots_[i].track != track)
    i = Next(i);
  if (slots_[i].value < 0) ++used_;
  slots_[i] = {track, value};
}

void TrackTable::Erase(std::int64_t track) {
  std::size_t hole = Home(track);
  while (slots_[hole].value >= 0 && slots_[hole].track != track)
    hole = Next(hole);
  if (slots_[hole].value < 0) return;
  --used_;
  // What follows moves up where its home is not between the hole and itself, so that no search ends
  // at the hole too early.
  for (std::size_t i = Next(hole); slots_[i].value >= 0; i = Next(i)) {
    const std::size_t home = Home(slots_[i].track), mask = slots_.size() - 1;
    if (((i - home) & mask) >= ((i - hole) & mask)) {
      slots_[hole] = slots_[i];
      hole = i;
    }
  }
  slots_[hole] = {};
}

void TrackTable::Clear() {
  std::fill(slots_.begin(), slots_.end(), Slot{});
  used_ = 0;
}

void TrackTable::Grow() {
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  used_ = 0;
  for (const Slot& slot : old) {
    if (slot.value >= 0) Set(slot.track, slot.value);
  }
}

}  // namespace glissade::internal
