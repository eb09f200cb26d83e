// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What a graph says about calls that it refuses, and what it remembers of them.

#include <algorithm>
#include <string>
#include <utility>

#include "glissade/graph/pools.h"

namespace glissade {

namespace {

template <class Handle>
Status Unknown(const Handle& handle, std::string_view kind, bool was_here) {
  std::string message = std::string(kind) + " " + ToString(handle) + " is not in this graph";
  if (!handle) {
    message += ": a null handle";
  } else if (was_here) {
    message += " any more";
  } else if (handle.graph != 0) {
    message += ", but of another one";
  }
  return {StatusCode::kUnknownHandle, std::move(message), handle};
}

}  // namespace

Status Graph::UnknownHandle(AnyVertex vertex) const {
  const VertexPoolBase* pool = PoolOf(vertex.type);
  const bool was_here = pool != nullptr && pool->slots().Contained(vertex);
  return Unknown(vertex, "vertex", was_here || (id_ != 0 && vertex.graph == id_));
}

Status Graph::UnknownHandle(AnyEdge edge) const {
  const EdgePoolBase* pool = EdgePoolOf(edge.type);
  const bool was_here = pool != nullptr && pool->slots().Contained(edge);
  return Unknown(edge, "edge", was_here || (id_ != 0 && edge.graph == id_));
}

Status Graph::Refused(Status status) {
  if (!status.ok() && first_refusal_.ok()) first_refusal_ = status;
  return status;
}

Status Graph::AcknowledgeRefusal() {
  return std::exchange(first_refusal_, {});
}

Status Graph::ReadyToSolve() const {
  if (!first_refusal_.ok()) {
    return internal::About(first_refusal_,
                           "refused before this solve, and not acknowledged since "
                           "(AcknowledgeRefusal)");
  }
  if (NumEdges() > 0) return {};
  return {StatusCode::kNothingToSolve,
          NumVertices() == 0 ? "the graph is empty" : "the graph has no edges"};
}

}  // namespace glissade
