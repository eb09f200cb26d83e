// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"

namespace glissade::python {

void BindFiles(nb::module_& m, nb::class_<PyProblem>& problem) {
  BindBal(m, problem);
  BindColmap(m, problem);
  BindViowin(m, problem);
  BindG2o(m, problem);
  BindScenes(m, problem);
}

}  // namespace glissade::python
