// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"

namespace glissade {

/// The instruction set that this process computes with: "baseline", "avx2" or "avx512". The best
/// that the machine has, unless the environment variable GLISSADE_ISA names a lesser one. Read
/// once, when something is first computed.
const char* InstructionSetName();

/// kInvalidArgument where GLISSADE_ISA names none of baseline, avx2 and avx512, or one that this
/// machine has not: Solve, Marginalize and Covariance then fail with this, rather than compute by
/// another one than was asked for.
Status CheckInstructionSet();

}  // namespace glissade
