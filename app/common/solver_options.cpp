// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/solver_options.h"

#include <fmt/format.h>

#include <cstdint>
#include <string_view>

#include "common/interrupt.h"
#include "common/options.h"
#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "glissade/losses/tukey.h"

namespace glissade::app {

namespace {

/// "huber:2" is a word and a number, 1 where there is none.
double NumberAfter(const std::string& option, const std::string& text, std::size_t colon,
                   double low, double high) {
  if (colon == std::string::npos) return 1.0;
  const Result<double> number = ParseNumber(option, text.substr(colon + 1), low, high);
  if (!number.ok()) RefuseOption(number.status().message() + " in '" + text + "'");
  return *number;
}

void SetMethod(std::string_view method, SolveOptions* solve) {
  if (method == "dogleg") solve->method = Method::kDogleg;
  if (method != "nielsen" && method != "course") return;
  const SolveOptions library;
  solve->damping = method == "course" ? Damping::kPoseBlock : Damping::kIdentity;
  solve->initial_lambda = 1e-5;
  solve->min_lambda = library.min_lambda;
  solve->min_relative_decrease = library.min_relative_decrease;
  if (method == "course") {
    // No rule on the cost or the gradient: this damping can make steps small far from the optimum.
    solve->cost_tolerance = 0.0;
    solve->gradient_tolerance = 0.0;
  }
}

}  // namespace

SolveOptions SolverOptions::Chosen() const {
  SolveOptions chosen = solve;
  SetMethod(method, &chosen);
  chosen.linear_solver_type = linear_solver == "dense"          ? LinearSolverType::kDenseCholesky
                              : linear_solver == "sparse"       ? LinearSolverType::kSparseCholesky
                              : linear_solver == "pcg"          ? LinearSolverType::kPcg
                              : linear_solver == "implicit-pcg" ? LinearSolverType::kImplicitPcg
                                                                : LinearSolverType::kAuto;
  chosen.pcg.preconditioner = preconditioner == "jacobi"           ? Preconditioner::kJacobi
                              : preconditioner == "cluster-jacobi" ? Preconditioner::kClusterJacobi
                              : preconditioner == "power-series"   ? Preconditioner::kPowerSeries
                                                                   : Preconditioner::kBlockJacobi;
  StopWhenInterrupted(&chosen);
  return chosen;
}

Gauge SolverOptions::GaugeAt(VertexHandle<VertexPose> anchor) const {
  if (gauge == Gauge::Kind::kFixed) return Gauge::Fixed{anchor};
  if (gauge == Gauge::Kind::kPrior) return Gauge::Prior{anchor, gauge_weight};
  return Gauge::Free;
}

void AddMethod(CLI::App& cli, SolverOptions* options, bool with_course) {
  std::vector<std::string> words = {"lm", "nielsen", "dogleg"};
  std::string help =
      "'lm': Levenberg-Marquardt, lambda diag(H). 'nielsen': the same, lambda I from 1e-5 "
      "max diag(H) on. 'dogleg'.";
  if (with_course) {
    words.emplace_back("course");
    help += " 'course': lambda I on the pose block, from 1e-5 max diag(H) on.";
  }
  AddChoice(cli, "--method", &options->method, std::move(words),
            help + " Default: " + options->method);
}

void AddLinearSolver(CLI::App& cli, SolverOptions* options) {
  AddChoice(cli, "--linear-solver", &options->linear_solver,
            {"auto", "dense", "sparse", "pcg", "implicit-pcg"},
            "Of the reduced system: 'auto' (default), what has least to do; 'dense' or 'sparse' "
            "Cholesky; 'pcg', conjugate gradients; 'implicit-pcg', the same without forming the "
            "system, with the least memory");
}

void AddPcg(CLI::App& cli, SolverOptions* options) {
  AddChoice(cli, "--preconditioner", &options->preconditioner,
            {"jacobi", "block-jacobi", "cluster-jacobi", "power-series"},
            "Of conjugate gradients: 'jacobi'; 'block-jacobi' (default), a block a camera; "
            "'cluster-jacobi', a block for up to 16 cameras that see the same points; "
            "'power-series', the first terms of the inverse");
  const std::string name = "--forcing";
  cli.add_option_function<std::string>(
         name,
         [=](const std::string& text) {
           const Result<double> number = ParseNumber(name, text, 0.0, 0.999);
           if (!number.ok()) RefuseOption(number.status().message());
           options->solve.pcg.forcing = *number;
         },
         fmt::format("Conjugate gradients stop where an iteration gains less than X of what was "
                     "gained so far (default {:g}). 0: go on to a residual of 1e-10",
                     options->solve.pcg.forcing))
      ->type_name("X");
}

void AddMemoryLimit(CLI::App& cli, SolverOptions* options) {
  const std::string name = "--memory-limit";
  cli.add_option_function<std::string>(
         name,
         [=](const std::string& text) {
           constexpr std::string_view kUnits = "kMG";
           double unit = 1e6;
           std::string digits = text;
           if (!digits.empty()) {
             const std::size_t found = kUnits.find(digits.back());
             if (found != std::string_view::npos) {
               unit = found == 0 ? 1e3 : found == 1 ? 1e6 : 1e9;
               digits.pop_back();
             }
           }
           const Result<double> number = ParseNumber(name, digits, 0.0, 1e6);
           if (!number.ok()) RefuseOption(number.status().message());
           options->solve.memory_limit = static_cast<std::int64_t>(*number * unit);
         },
         "Refuse, or take another solver, before problem and solve need more than SIZE: 800M, 2G; "
         "megabytes without a unit (default 0: no limit)")
      ->type_name("SIZE");
}

void AddIterations(CLI::App& cli, SolverOptions* options) {
  AddInteger(cli, "--iterations", &options->solve.max_iterations, 0, 1000000,
             fmt::format("At most N steps (default {})", options->solve.max_iterations));
}

void AddTolerance(CLI::App& cli, SolverOptions* options) {
  const std::string name = "--tolerance";
  cli.add_option_function<std::string>(
         name,
         [=](const std::string& text) {
           const Result<double> number = ParseNumber(name, text, 0.0, 0.999);
           if (!number.ok()) RefuseOption(number.status().message());
           const SolveOptions library;
           const bool off = *number == 0.0;
           options->solve.cost_tolerance = *number;
           options->solve.gradient_tolerance = off ? 0.0 : library.gradient_tolerance;
           options->solve.step_tolerance = off ? 0.0 : library.step_tolerance;
         },
         fmt::format("Stop when the cost falls by less than X of itself (default {:g}). 0: all "
                     "stopping rules off",
                     options->solve.cost_tolerance))
      ->type_name("X");
}

void AddThreads(CLI::App& cli, SolverOptions* options) {
  AddInteger(cli, "--threads", &options->solve.num_threads, 1, 1024,
             "Threads of a solve; the result is the same bits (default 1)");
}

void AddLoss(CLI::App& cli, SolverOptions* options, const std::string& unit) {
  const std::string name = "--loss";
  cli.add_option_function<std::string>(
         name,
         [=](const std::string& text) {
           const std::size_t colon = text.find(':');
           const std::string word = text.substr(0, colon);
           const bool known = word == "huber" || word == "cauchy" || word == "tukey";
           if (!known && text != "none") {
             RefuseOption(fmt::format(
                 "{}: must be none, huber:W, cauchy:W or tukey:W, W the width, not '{}'", name,
                 text));
           }
           // The square of a width must be a number, too.
           const double width = NumberAfter(name, text, colon, 1e-100, 1e100);
           options->loss = Loss();
           if (word == "huber") options->loss = Huber{width};
           if (word == "cauchy") options->loss = Cauchy{width};
           if (word == "tukey") options->loss = Tukey{width};
         },
         fmt::format("Of the observations: 'none' (default), 'huber:W', 'cauchy:W' or 'tukey:W', W "
                     "the width in {} (default 1)",
                     unit))
      ->type_name("none|huber:W|cauchy:W|tukey:W");
}

void AddGauge(CLI::App& cli, SolverOptions* options) {
  const std::string name = "--gauge";
  cli.add_option_function<std::string>(
         name,
         [=](const std::string& text) {
           const std::size_t colon = text.find(':');
           const std::string word = text.substr(0, colon);
           if (text == "free" || text == "fixed") {
             options->gauge = text == "free" ? Gauge::Kind::kFree : Gauge::Kind::kFixed;
           } else if (word == "prior" && colon != std::string::npos) {
             options->gauge = Gauge::Kind::kPrior;
             options->gauge_weight = NumberAfter(name, text, colon, 1e-30, 1e30);
           } else {
             RefuseOption(fmt::format("{}: must be free, fixed or prior:W, W the weight, not '{}'",
                                      name, text));
           }
         },
         "What holds the directions that nothing observes, on the first keyframe: 'free' "
         "(default), "
         "only what the file's priors say; 'fixed'; 'prior:W' with weight W (1/m^2 and 1/rad^2)")
      ->type_name("free|fixed|prior:W");
}

}  // namespace glissade::app
