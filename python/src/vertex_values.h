// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "arrays.h"

namespace glissade::python {

/// Rows of the numbers of vertices.
template <class V>
OutArray ValuesOf(const std::vector<V>& vertices) {
  std::vector<double> values;
  values.reserve(vertices.size() * V::kAmbientDim);
  for (const V& v : vertices)
    values.insert(values.end(), v.Data(), v.Data() + V::kAmbientDim);
  return Own(std::move(values), {vertices.size(), static_cast<std::size_t>(V::kAmbientDim)});
}

}  // namespace glissade::python
