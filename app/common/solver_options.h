// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "glissade/gauge/gauge.h"
#include "glissade/losses/loss.h"
#include "glissade/minimizer/options.h"

/// \file
/// The options of a solve, with the same names and words in all apps. An app adds those that make
/// sense for it, after it has set its own defaults in the struct.
namespace glissade::app {

struct SolverOptions {
  SolveOptions solve;
  std::string method = "lm";
  std::string linear_solver = "auto";
  std::string preconditioner = "block-jacobi";
  Loss loss;
  Gauge::Kind gauge = Gauge::Kind::kFree;
  double gauge_weight = 0.0;  ///< of kPrior (1/m^2 and 1/rad^2)

  /// The solve's options with the method and linear solver chosen, ended by an interrupt.
  [[nodiscard]] SolveOptions Chosen() const;
  /// The gauge chosen, on this pose.
  [[nodiscard]] Gauge GaugeAt(VertexHandle<VertexPose> anchor) const;
};

/// --method lm|nielsen|dogleg, and course where asked.
void AddMethod(CLI::App& cli, SolverOptions* options, bool with_course = false);
/// --linear-solver auto|dense|sparse|pcg|implicit-pcg
void AddLinearSolver(CLI::App& cli, SolverOptions* options);
/// --preconditioner jacobi|block-jacobi|cluster-jacobi|power-series, --forcing X: of pcg
void AddPcg(CLI::App& cli, SolverOptions* options);
/// --memory-limit SIZE
void AddMemoryLimit(CLI::App& cli, SolverOptions* options);
/// --iterations N
void AddIterations(CLI::App& cli, SolverOptions* options);
/// --tolerance X: of the cost; 0 switches all stopping rules off.
void AddTolerance(CLI::App& cli, SolverOptions* options);
/// --threads N, of a solve
void AddThreads(CLI::App& cli, SolverOptions* options);
/// --loss none|huber:W|cauchy:W|tukey:W, W in the unit given, 1 where it is left out
void AddLoss(CLI::App& cli, SolverOptions* options, const std::string& unit);
/// --gauge free|fixed|prior:W
void AddGauge(CLI::App& cli, SolverOptions* options);

}  // namespace glissade::app
