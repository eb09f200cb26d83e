// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/minimizer/options.h"

/// \file
/// Ctrl-C and SIGTERM: the first ends the work as soon as there is a state to be left with, and
/// what was reached is written as always; the second ends the program at once.
namespace glissade::app {

void CatchInterrupts();
bool Interrupted();
/// 128 + signal, what shells give a program that a signal ended: 130 for Ctrl-C.
int InterruptedExitCode();

/// Makes a solve with these options end, with the best state so far, when interrupted. Goes around
/// the callback that the options have.
void StopWhenInterrupted(SolveOptions* options);

}  // namespace glissade::app
