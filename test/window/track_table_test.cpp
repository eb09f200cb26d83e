// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/track_table.h"

#include <gtest/gtest.h>

#include <map>

#include "common/random_states.h"

namespace glissade::internal {
namespace {

TEST(TrackTable, IsAMap) {
  test::Random random(1);
  TrackTable table;
  std::map<std::int64_t, int> reference;
  for (int k = 0; k < 20000; ++k) {
    // Few different numbers, and many that collide: multiples of large powers of two.
    const auto track = static_cast<std::int64_t>(random.Uniform(-200.0, 200.0)) *
                       (k % 3 == 0 ? std::int64_t{1} << 40 : 1);
    if (random.Uniform(0.0, 1.0) < 0.5) {
      table.Set(track, k);
      reference[track] = k;
    } else {
      table.Erase(track);
      reference.erase(track);
    }
    const auto probe = static_cast<std::int64_t>(random.Uniform(-200.0, 200.0));
    const auto found = reference.find(probe);
    ASSERT_EQ(table.Find(probe), found == reference.end() ? -1 : found->second);
  }
  for (const auto& [track, value] : reference)
    ASSERT_EQ(table.Find(track), value);
  table.Clear();
  for (const auto& [track, value] : reference)
    ASSERT_EQ(table.Find(track), -1);
}

}  // namespace
}  // namespace glissade::internal
