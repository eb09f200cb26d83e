// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "glissade/base/handle.h"

/// \file
/// Handles of vertices and edges as Python has them: many at once, indexed like a numpy array.
namespace glissade::python {

template <class Handle>
struct HandleArray {
  HandleArray() = default;
  explicit HandleArray(std::vector<Handle> h) : handles(std::move(h)) {}

  std::vector<Handle> handles;

  [[nodiscard]] std::size_t size() const { return handles.size(); }
  [[nodiscard]] const Handle& operator[](std::size_t i) const { return handles[i]; }
  /// The handle, or the only one that there is for all of n.
  [[nodiscard]] const Handle& ForEach(std::size_t i) const {
    return handles.size() == 1 ? handles[0] : handles[i];
  }
  /// "VertexPose", "mixed", or "" of none.
  [[nodiscard]] std::string TypeName() const;
};

using VertexArray = HandleArray<AnyVertex>;
using EdgeArray = HandleArray<AnyEdge>;

template <class Handle, class Typed>
HandleArray<Handle> ArrayOf(const std::vector<Typed>& handles) {
  return HandleArray<Handle>(std::vector<Handle>(handles.begin(), handles.end()));
}

/// ValueError unless there are n, or one for all.
void ExpectOneOr(const VertexArray& array, std::size_t n, const char* name);
/// The only one; ValueError where there is none or are more.
AnyVertex OnlyOne(const VertexArray& array, const char* name);

void BindHandles(nb::module_& m);

}  // namespace glissade::python
