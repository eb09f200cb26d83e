// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/matrix.h"
#include "glissade/edges/concept.h"
#include "glissade/vertices/vector.h"

namespace glissade::test {

/// Rosenbrock's valley: r = (10 (y - x^2), 1 - x).
struct EdgeRosenbrock {
  using Vertices = VertexList<VertexVector<2>>;
  static constexpr int kResidualDim = 2;
  bool Evaluate(const VertexVector<2>& v, Vector<2>& r, Jacobian<2, 2>* J) const {
    const double x = v.Data()[0], y = v.Data()[1];
    r << 10.0 * (y - x * x), 1.0 - x;
    if (J != nullptr) *J << -20.0 * x, 10.0, -1.0, 0.0;
    return true;
  }
};

}  // namespace glissade::test
