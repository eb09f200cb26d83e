// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ba/run.h"
#include "glissade/base/status.h"
#include "glissade/io/bal.h"

namespace glissade::bench {

/// A library with one choice of its options.
struct Solver {
  std::string name;           ///< "glissade-sparse", "ceres-dense"
  std::string about;          ///< in its own library's words
  int max_cameras = 1 << 30;  ///< not run on larger problems
  bool by_default = true;     ///< run where nobody says which
  /// Solves, telling the recorder; returns cameras and points of the solution. The problem is
  /// handed over: what is not needed any more is freed.
  std::function<Result<BalProblem>(BalProblem problem, const Settings&, Recorder*)> solve;
};

[[nodiscard]] std::vector<Solver> GlissadeSolvers();
/// Empty in a build without Ceres.
[[nodiscard]] std::vector<Solver> CeresSolvers();
/// "2.1.0"; empty without.
[[nodiscard]] std::string CeresVersion();

}  // namespace glissade::bench
