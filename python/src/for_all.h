// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unordered_set>

#include "errors.h"
#include "handles.h"
#include "problem.h"

namespace glissade::python {

template <class Handle>
void ExpectKnown(PyProblem& p, const HandleArray<Handle>& array) {
  for (const Handle& handle : array.handles) {
    if (!p.read().Contains(handle)) Raise(p.read().UnknownHandle(handle));
  }
}

/// For what can be done to each only once.
template <class Handle>
void ExpectKnownOnce(PyProblem& p, const HandleArray<Handle>& array) {
  ExpectKnown(p, array);
  std::unordered_set<Handle> seen;
  for (const Handle& handle : array.handles) {
    if (seen.insert(handle).second) continue;
    Raise(Status(StatusCode::kInvalidArgument, ToString(handle) + " is there twice", handle));
  }
}

/// f(vertex), a Status, for all of them, or for none: undo(k) takes back what was done to the k-th.
template <class F, class Undo>
void ForAll(PyProblem& p, const VertexArray& vertices, F&& f, Undo&& undo) {
  ExpectKnown(p, vertices);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Status status = f(vertices[k]);
    if (status.ok()) continue;
    while (k-- > 0)
      undo(k);
    p.Seen(status);
  }
}

}  // namespace glissade::python
