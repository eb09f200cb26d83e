// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/interrupt.h"

#include <csignal>
#include <utility>

namespace glissade::app {

namespace {

volatile std::sig_atomic_t caught_signal = 0;

void Remember(int signal) {
  caught_signal = signal;
}

}  // namespace

void CatchInterrupts() {
  struct sigaction action {};
  action.sa_handler = Remember;
  // Whoever does not want to wait asks twice. Interrupted reads and writes are taken up again.
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) {
    // Started with the signal ignored (nohup, a background job of a script) it stays ignored.
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

bool Interrupted() {
  return caught_signal != 0;
}

int InterruptedExitCode() {
  return 128 + caught_signal;
}

void StopWhenInterrupted(SolveOptions* options) {
  options->callback = [inner = std::move(options->callback)](const IterationSummary& iteration) {
    const CallbackAction action = inner ? inner(iteration) : CallbackAction::kContinue;
    return Interrupted() ? CallbackAction::kStop : action;
  };
}

}  // namespace glissade::app
