// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "errors.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "handles.h"

namespace glissade::python {

namespace nb = nanobind;

void Raise(const Status& status) {
  nb::object type = nb::module_::import_("glissade._errors").attr("Error");
  nb::object vertex = nb::none(), edge = nb::none();
  if (status.vertex()) vertex = nb::cast(VertexArray({status.vertex()}));
  if (status.edge()) edge = nb::cast(EdgeArray({status.edge()}));
  nb::object error = type(nb::cast(status.message()), nb::cast(status.code()), vertex, edge);
  PyErr_SetObject(type.ptr(), error.ptr());
  throw nb::python_error();
}

}  // namespace glissade::python
