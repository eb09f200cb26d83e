// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "errors.h"
#include "handles.h"
#include "problem.h"

namespace glissade::python {

/// f(vertex), a Status, for all of them, or for none where one is unknown.
template <class F>
void ForAll(PyProblem& p, const VertexArray& vertices, F&& f) {
  for (const AnyVertex& v : vertices.handles) {
    if (!p.read().Contains(v)) Raise(p.read().UnknownHandle(v));
  }
  for (const AnyVertex& v : vertices.handles)
    p.Seen(f(v));
}

}  // namespace glissade::python
