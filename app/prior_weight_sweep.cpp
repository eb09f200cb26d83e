// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What the weight of a prior on the gauge does to accuracy and to convergence.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/course.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/solver_options.h"
#include "common/version.h"
#include "studies/sweep.h"

namespace {

using namespace glissade;

constexpr const char* kName = "prior_weight_sweep";

constexpr const char* kDescription =
    R"(How heavy should a prior be that fixes the gauge of a monocular problem? Solves the
course scene with priors of different weights on its first two poses, and once with these
poses held, and compares: accuracy, iterations, time, and the way to the solution.)";

constexpr const char* kFooter =
    R"(Columns:
  weight        information of the priors (1/m^2, 1/rad^2); 0: none; fixed: first two poses held
  pose error    sum over the poses of |t - t_true| (m), mean of the trials
  point error   sum over the points of |rho - rho_true| (1/m), mean of the trials
  spread        largest minus smallest pose error of the trials: 0 when all converge to one place
  iterations    linear solves, median of the trials
  converged     trials that ended by a rule of convergence
With --verbose, for the first trial, after each accepted step:
  reprojection  RMS over the observations (normalized image plane)
  prior err.    RMS over the first two poses of their distance from the priors (m, rad)

Weight 0 has no errors of its own: a free solution ends anywhere on its 7-dimensional gauge orbit.
Its errors are what remains after the similarity transformation that takes the three camera
centres closest to the truth. That explains 7 of their 9 numbers: compare it with itself only.

The errors of a solve that has converged tend to those of fixed poses as 1 / weight. The course's
code stops before (--course-stop, which takes its method, too): its damping starts at 1e-5 max
diag(H), which a heavy prior raises, and it ends at the first small step. With poses that start at
the truth this looks like errors that fall with the weight to nothing: they are the start, not a
solution.

Examples:
  prior_weight_sweep
  prior_weight_sweep --pose-noise 0.1 --trials 20      the same errors from other starts
  prior_weight_sweep --course-stop                     what the course's code reports
  prior_weight_sweep --weights 0,1,10,100,1e3,1e4,1e5,1e6 --pose-noise 0.1 --json sweep.json
  scripts/plot_prior_weight.py sweep.json docs/images  draws it

After Ctrl-C the trials until then are shown and written.

Exit code: 0; 130 after Ctrl-C; 2 where an option or the scene makes no sense.)";

struct Options {
  app::SweepOptions sweep;
  app::SolverOptions solver;
  bool verbose = false;
  std::string scene;
  std::string csv;
  std::string json;

  Options() {
    sweep.weights = {0.0, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8};
    // Until steps are tiny, and by no other rule: what is compared has converged.
    solver.solve.cost_tolerance = 0.0;
    solver.solve.gradient_tolerance = 0.0;
    solver.solve.max_iterations = 500;
  }
};

void AddOptions(app::Program& program, Options& o) {
  CLI::App& cli = program.cli();
  app::AddNumbers(cli, "--weights", &o.sweep.weights, 0.0, 1e30,
                  "Weights, separated by commas (default 0,1e3,...,1e8)");
  app::AddNumber(cli, "--pose-noise", &o.sweep.pose_noise, 0.0, 1e3,
                 "Sigma of a Gaussian on every axis of every start pose (m and rad; default 0)");
  app::AddInteger(cli, "--trials", &o.sweep.trials, 1, 100000,
                  "Repetitions of everything random: start poses per weight (default 1)");
  app::AddSeed(cli, &o.sweep.seed, "the pose noise");
  app::AddMethod(cli, &o.solver, true);
  cli.add_flag("--course-stop", o.solver.solve.course_stop,
               "Stop where the course's code does: before a step with |dx|^2 <= 1e-6");
  app::AddLinearSolver(cli, &o.solver);
  app::AddIterations(cli, &o.solver);
  app::AddThreads(cli, &o.solver);
  cli.add_option("--scene", o.scene, "Solve the scene of FILE, not the built-in one")
      ->type_name("FILE");
  cli.add_flag("--verbose", o.verbose, "Print every step, too");
  program.AddOutput("--csv", &o.csv, "Write one line per trial (CSV) to FILE");
  program.AddJson(&o.json);
}

/// The trials of a row in one line.
struct RowSummary {
  double pose_error = 0.0, pose_error_spread = 0.0, point_error = 0.0, iterations = 0.0,
         time_ms = 0.0;
  int converged = 0;
};

double Median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  const std::size_t half = x.size() / 2;
  return x.size() % 2 == 1 ? x[half] : 0.5 * (x[half - 1] + x[half]);
}

RowSummary Summarize(const app::SweepRow& row) {
  RowSummary sum;
  std::vector<double> pose, iterations, time;
  for (const app::SweepTrial& trial : row.trials) {
    pose.push_back(trial.errors.pose);
    iterations.push_back(trial.iterations);
    time.push_back(1e3 * trial.time_s);
    sum.pose_error += trial.errors.pose / static_cast<double>(row.trials.size());
    sum.point_error += trial.errors.point / static_cast<double>(row.trials.size());
    sum.converged += trial.converged ? 1 : 0;
  }
  const auto [low, high] = std::minmax_element(pose.begin(), pose.end());
  sum.pose_error_spread = *high - *low;
  sum.iterations = Median(iterations);
  sum.time_ms = Median(time);
  return sum;
}

std::string WeightName(const app::SweepRow& row) {
  return row.fixed ? "fixed" : fmt::format("{:g}", row.weight);
}

void PrintTable(const std::vector<app::SweepRow>& rows) {
  app::Print("{:>8} {:>16} {:>14} {:>10} {:>11} {:>10} {:>10}\n", "weight", "pose error [m]",
             "point err [1/m]", "spread [m]", "iterations", "time [ms]", "converged");
  for (const app::SweepRow& row : rows) {
    const RowSummary sum = Summarize(row);
    app::Print("{:>8} {:>16.8g} {:>15.8g} {:>10.1e} {:>11g} {:>10.4f} {:>6}/{}\n", WeightName(row),
               sum.pose_error, sum.point_error, sum.pose_error_spread, sum.iterations, sum.time_ms,
               sum.converged, row.trials.size());
  }
}

/// The way of the first trial of every weight.
void PrintPaths(const std::vector<app::SweepRow>& rows) {
  app::Print("\n{:>8} {:>9} {:>14} {:>18} {:>16} {:>18}\n", "weight", "iteration", "cost",
             "reprojection [RMS]", "prior err. [m]", "prior err. [rad]");
  for (const app::SweepRow& row : rows) {
    for (const app::SweepStep& step : row.trials[0].steps) {
      app::Print("{:>8} {:>9} {:>14.6e} {:>18.6e} {:>16.6e} {:>18.6e}\n", WeightName(row),
                 step.iteration, step.cost, step.reprojection_error, step.prior_position_error,
                 step.prior_rotation_error);
    }
  }
}

std::string ToCsv(const std::vector<app::SweepRow>& rows) {
  std::string text =
      "weight,trial,pose_error_m,point_error_per_m,iterations,time_ms,status,converged\n";
  for (const app::SweepRow& row : rows) {
    for (std::size_t k = 0; k < row.trials.size(); ++k) {
      const app::SweepTrial& trial = row.trials[k];
      fmt::format_to(std::back_inserter(text), "{},{},{:.17g},{:.17g},{},{:.6g},{},{}\n",
                     row.fixed ? "fixed" : fmt::format("{:.17g}", row.weight), k, trial.errors.pose,
                     trial.errors.point, trial.iterations, 1e3 * trial.time_s,
                     ToString(trial.termination), trial.converged ? 1 : 0);
    }
  }
  return text;
}

nlohmann::ordered_json ToJson(const app::SweepRow& row) {
  const RowSummary sum = Summarize(row);
  nlohmann::ordered_json json = {
      {"fixed", row.fixed},
      {"weight", row.fixed ? nlohmann::json() : nlohmann::json(row.weight)},
      {"aligned", !row.fixed && row.weight == 0.0},
      {"pose_error_m", sum.pose_error},
      {"pose_error_spread_m", sum.pose_error_spread},
      {"point_error_per_m", sum.point_error},
      {"iterations", sum.iterations},
      {"time_ms", sum.time_ms},
      {"converged_trials", sum.converged}};
  json["trials"] = nlohmann::json::array();
  for (const app::SweepTrial& trial : row.trials) {
    nlohmann::ordered_json t = {
        {"pose_error_m", trial.errors.pose},     {"point_error_per_m", trial.errors.point},
        {"iterations", trial.iterations},        {"time_ms", 1e3 * trial.time_s},
        {"status", ToString(trial.termination)}, {"converged", trial.converged}};
    t["steps"] = nlohmann::json::array();
    for (const app::SweepStep& step : trial.steps) {
      t["steps"].push_back(
          nlohmann::ordered_json{{"iteration", step.iteration},
                                 {"cost", step.cost},
                                 {"reprojection_error", step.reprojection_error},
                                 {"prior_position_error_m", step.prior_position_error},
                                 {"prior_rotation_error_rad", step.prior_rotation_error}});
    }
    json["trials"].push_back(std::move(t));
  }
  return json;
}

nlohmann::ordered_json ToJson(const std::vector<app::SweepRow>& rows, const Options& o) {
  nlohmann::ordered_json json = app::JsonHeader(kName, o.scene);
  json.update({{"pose_noise_m_rad", o.sweep.pose_noise},
               {"trials", o.sweep.trials},
               {"seed", o.sweep.seed},
               {"method", o.solver.method},
               {"linear_solver", o.solver.linear_solver},
               {"course_stop", o.solver.solve.course_stop}});
  json["rows"] = nlohmann::json::array();
  for (const app::SweepRow& row : rows)
    json["rows"].push_back(ToJson(row));
  return json;
}

app::Outcome Run(Options o) {
  if (o.solver.solve.course_stop) o.solver.method = "course";
  o.sweep.solve = o.solver.Chosen();
  const auto scene = app::LoadScene(o.scene);
  if (!scene.ok()) return app::BadInput(scene.status());
  const auto rows = app::RunSweep(*scene, o.sweep);
  if (!rows.ok()) return app::BadInput(rows.status());

  PrintTable(*rows);
  if (o.verbose) PrintPaths(*rows);
  Status written;
  if (!o.csv.empty()) written = app::WriteFile(o.csv, ToCsv(*rows));
  if (written.ok() && !o.json.empty()) written = app::WriteJson(o.json, ToJson(*rows, o), 1);
  return written.ok() ? app::Outcome{} : app::Failed(written);
}

}  // namespace

int main(int argc, char** argv) {
  return app::Program(kName, kDescription, kFooter).Main<Options>(argc, argv, AddOptions, Run);
}
