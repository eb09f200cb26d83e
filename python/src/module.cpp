// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>

#include "glissade/base/status.h"
#include "glissade/version.h"
#include "handles.h"
#include "problem.h"
#include "unlocked.h"

namespace nb = nanobind;
using namespace nb::literals;

NB_MODULE(_core, m) {
  using namespace glissade;
  m.doc() = "The compiled part of glissade.";
  // An edge kind that keeps its problem is a cycle, which is freed with the interpreter: no error.
  nb::set_leak_warnings(false);
  m.attr("version") =
      nb::str("{}.{}.{}")
          .format(GLISSADE_VERSION_MAJOR, GLISSADE_VERSION_MINOR, GLISSADE_VERSION_PATCH);
  nb::enum_<StatusCode>(m, "StatusCode", "What went wrong: Error.code.")
      .value("OK", StatusCode::kOk)
      .value("INVALID_ARGUMENT", StatusCode::kInvalidArgument)
      .value("UNKNOWN_HANDLE", StatusCode::kUnknownHandle)
      .value("NOT_FINITE", StatusCode::kNotFinite)
      .value("NOT_POSITIVE", StatusCode::kNotPositive)
      .value("DUPLICATE", StatusCode::kDuplicate)
      .value("ELIMINATED_PAIR", StatusCode::kEliminatedPair)
      .value("REPEATED_VERTEX", StatusCode::kRepeatedVertex)
      .value("UNDER_PRIOR", StatusCode::kUnderPrior)
      .value("NOTHING_TO_SOLVE", StatusCode::kNothingToSolve)
      .value("SINGULAR", StatusCode::kSingular)
      .value("EVALUATION_FAILED", StatusCode::kEvaluationFailed)
      .value("IO_ERROR", StatusCode::kIoError)
      .value("PARSE_ERROR", StatusCode::kParseError)
      .value("OUT_OF_MEMORY", StatusCode::kOutOfMemory);
  // Types come before what has them as a default argument.
  python::BindExit();
  python::BindHandles(m);
  python::BindGauge(m);
  python::BindSolveOptions(m);
  python::BindImu(m);
  python::BindProblem(m);
  python::BindTrajectories(m);
  python::BindWindow(m);
}
