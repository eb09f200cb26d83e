// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include "common/random_states.h"
#include "glissade/testing.h"

namespace glissade::test {

/// EXPECT that the Jacobians of `edge` hold at these vertices (1e-7 relative).
template <class E, class... V>
void ExpectJacobians(const E& edge, const V&... vertices) {
  const JacobianCheck check = CheckJacobians(edge, vertices...);
  EXPECT_TRUE(check.ok) << check.message;
}

}  // namespace glissade::test
