// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "unlocked.h"

#include <atomic>
#include <chrono>
#include <thread>

namespace glissade::python {

namespace nb = nanobind;

namespace {

std::atomic<int> num_working{0};
std::atomic<bool> ends{false};

}  // namespace

Unlocked::Unlocked() {
  if (ends) {
    throw nb::builtin_exception(nb::exception_type::runtime_error, "the interpreter is ending");
  }
  ++num_working;
  release_.emplace();
}

Unlocked::~Unlocked() {
  release_.reset();
  --num_working;
}

bool InterpreterEnds() {
  return ends;
}

void BindExit() {
  nb::module_::import_("atexit").attr("register")(nb::cpp_function([] {
    ends = true;
    const nb::gil_scoped_release release;
    while (num_working > 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }));
}

}  // namespace glissade::python
