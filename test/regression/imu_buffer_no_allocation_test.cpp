// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "glissade/imu/buffer.h"
#include "regression/malloc_count.h"

namespace glissade {
namespace {

// Each sample and each interval made a message for a refusal that did not come.
TEST(ImuBufferNoAllocation, FromFrameToFrame) {
  if (test::MallocCount() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  constexpr std::int64_t kStep = 5'000'000, kFrame = 20 * kStep;
  ImuBuffer buffer;
  ImuInterval interval;
  ImuSample sample;
  std::int64_t settled = 0;
  for (std::int64_t frame = 0; frame < 300; ++frame) {
    if (frame == 50) settled = test::MallocCount();
    for (std::int64_t k = 0; k < 20; ++k) {
      sample.stamp_ns = frame * kFrame + k * kStep;
      ASSERT_TRUE(buffer.Add(sample).ok());
    }
    if (frame < 20) continue;
    const std::int64_t end = frame * kFrame + 7'654'321;
    ASSERT_TRUE(buffer.Between(end - kFrame, end, &interval).ok());
    ASSERT_EQ(interval.samples.size(), 22u);
    buffer.DropBefore(end - 10 * kFrame);
  }
  EXPECT_EQ(test::MallocCount() - settled, 0);
  EXPECT_EQ(buffer.counts().accepted, 6000);
}

}  // namespace
}  // namespace glissade
