// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glissade {

/// The instruction set that this process computes with: "baseline", "avx2" or "avx512". The best
/// that the machine has, unless the environment variable GLISSADE_ISA names a lesser one.
const char* InstructionSetName();

}  // namespace glissade
