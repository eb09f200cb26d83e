// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Sequences of 120 random calls against a plain model of the graph. How many: the environment
// variable GLISSADE_API_SEQUENCES; GLISSADE_API_SEED is the first seed.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "api/api_walk.h"
#include "common/sanitized.h"

namespace glissade::test {
namespace {

long FromEnvironment(const char* name, long otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::strtol(text, nullptr, 10) : otherwise;
}

TEST(RandomCalls, AgreeWithAPlainModel) {
  const long count = FromEnvironment("GLISSADE_API_SEQUENCES", kSanitized ? 60 : 500);
  const long first = FromEnvironment("GLISSADE_API_SEED", 1);
  for (long k = 0; k < count; ++k) {
    ApiWalk walk(static_cast<std::uint64_t>(first + k));
    const std::string failure = walk.Run(120);
    ASSERT_EQ(failure, "") << "seed " << first + k;
    if (count > 1000 && (k + 1) % 1000 == 0) std::fprintf(stderr, "%ld sequences\n", k + 1);
  }
}

}  // namespace
}  // namespace glissade::test
