// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem.h"

/// \file
/// Files and made scenes, a format each.
namespace glissade::python {

void BindBal(nb::module_& m, nb::class_<PyProblem>& problem);
void BindColmap(nb::module_& m, nb::class_<PyProblem>& problem);
void BindViowin(nb::module_& m, nb::class_<PyProblem>& problem);
void BindG2o(nb::module_& m, nb::class_<PyProblem>& problem);
void BindScenes(nb::module_& m, nb::class_<PyProblem>& problem);

}  // namespace glissade::python
