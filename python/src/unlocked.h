// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <optional>

namespace glissade::python {

/// For as long as it lives this thread works without the interpreter's lock. A thread that asks for
/// the lock when the interpreter has ended is ended with it, in the middle of whatever it does: so
/// the interpreter waits at its exit for those that work, and solves stop after their iteration.
/// RuntimeError where it is about to end.
class Unlocked {
 public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  std::optional<nanobind::gil_scoped_release> release_;
};

/// Whether the interpreter is about to end. Asks for no lock.
bool InterpreterEnds();

void BindExit();

}  // namespace glissade::python
