// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What the weight of a prior on the gauge does to accuracy and to convergence.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/cli.h"
#include "common/course.h"
#include "common/output_file.h"
#include "common/sweep.h"

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
code stops before (--course-stop): its damping starts at 1e-5 max diag(H), which a heavy prior
raises, and it ends at the first small step. With poses that start at the truth this looks like
errors that fall with the weight to nothing: they are the start, not a solution.

Examples:
  prior_weight_sweep
  prior_weight_sweep --pose-noise 0.1 --trials 20      the same errors from other starts
  prior_weight_sweep --course-stop                     what the course's code reports
  prior_weight_sweep --weights 0,1,10,100,1e3,1e4,1e5,1e6 --pose-noise 0.1 --json sweep.json
  scripts/plot_prior_weight.py sweep.json docs/images  draws it

Exit code: 0, or 2 where an option or the scene makes no sense.)";

struct Options {
  std::vector<double> weights = {0.0, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8};
  double pose_noise = 0.0;
  int trials = 1;
  std::int64_t seed = 1;
  int iterations = 500;
  std::string lm = "default";
  bool course_stop = false;
  bool verbose = false;
  std::string scene;
  std::string csv;
  std::string json;
};

void AddOptions(CLI::App& app, Options& o) {
  app.add_option("--weights", o.weights, "Weights, separated by commas (default 0,1e3,...,1e8)")
      ->delimiter(',')
      ->type_name("W,W,...");
  app.add_option("--pose-noise", o.pose_noise,
                 "Sigma of a Gaussian on every axis of every start pose (m and rad; default 0)")
      ->type_name("SIGMA");
  app.add_option("--trials", o.trials, "Start poses per weight (default 1)")->type_name("N");
  app.add_option("--seed", o.seed, "Seed of the pose noise (default 1)")->type_name("N");
  app.add_option("--lm", o.lm,
                 "'default': the library's. 'course': lambda I on the pose block, lambda0 = 1e-5 "
                 "max diag(H)")
      ->type_name("WHICH");
  app.add_flag("--course-stop", o.course_stop,
               "The course's Levenberg-Marquardt and its stopping rule, |dx|^2 <= 1e-6");
  app.add_option("--iterations", o.iterations, "At most N steps per solve (default 500)")
      ->type_name("N");
  app.add_option("--scene", o.scene, "Use the scene of FILE, not the built-in one")
      ->type_name("FILE");
  app.add_flag("--verbose", o.verbose, "Print prior and reprojection error of every step, too");
  app.add_option("--csv", o.csv, "Write one line per weight and trial to FILE")->type_name("FILE");
  app.add_option("--json", o.json, "Write everything, with the iterations, to FILE")
      ->type_name("FILE");
}

Status MakeSweepOptions(const Options& o, app::SweepOptions* sweep) {
  if (o.weights.empty()) return {StatusCode::kInvalidArgument, "--weights: none given"};
  for (double weight : o.weights) {
    if (Status s = app::CheckAtLeast("--weights", weight, 0.0); !s.ok()) return s;
  }
  if (o.lm != "default" && o.lm != "course") {
    return {StatusCode::kInvalidArgument, "--lm: must be default or course, not " + o.lm};
  }
  if (Status s = app::FirstError({
          app::CheckAtLeast("--pose-noise", o.pose_noise, 0.0),
          app::CheckRange("--trials", o.trials, 1, 100000),
          app::CheckRange("--seed", o.seed, 0, 4294967295),
          app::CheckRange("--iterations", o.iterations, 0, 1000000),
          app::CheckDifferent("--csv", o.csv, "--json", o.json),
          app::CheckWritable("--csv", o.csv),
          app::CheckWritable("--json", o.json),
      });
      !s.ok()) {
    return s;
  }
  sweep->weights = o.weights;
  sweep->pose_noise = o.pose_noise;
  sweep->trials = o.trials;
  sweep->seed = static_cast<std::uint32_t>(o.seed);
  if (o.lm == "course" || o.course_stop) sweep->solve = app::CourseLm();
  // Until steps are 1e-10 of the state, and by no other rule: what is compared has converged.
  sweep->solve.cost_tolerance = 0.0;
  sweep->solve.gradient_tolerance = 0.0;
  sweep->solve.step_tolerance = 1e-10;
  sweep->solve.course_stop = o.course_stop;
  sweep->solve.max_iterations = o.iterations;
  return {};
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
  fmt::print("{:>8} {:>16} {:>14} {:>10} {:>11} {:>10} {:>10}\n", "weight", "pose error [m]",
             "point err [1/m]", "spread [m]", "iterations", "time [ms]", "converged");
  for (const app::SweepRow& row : rows) {
    const RowSummary sum = Summarize(row);
    fmt::print("{:>8} {:>16.8g} {:>15.8g} {:>10.1e} {:>11g} {:>10.4f} {:>6}/{}\n", WeightName(row),
               sum.pose_error, sum.point_error, sum.pose_error_spread, sum.iterations, sum.time_ms,
               sum.converged, row.trials.size());
  }
}

/// The way of the first trial of every weight.
void PrintPaths(const std::vector<app::SweepRow>& rows) {
  fmt::print("\n{:>8} {:>9} {:>14} {:>18} {:>16} {:>18}\n", "weight", "iteration", "cost",
             "reprojection [RMS]", "prior err. [m]", "prior err. [rad]");
  for (const app::SweepRow& row : rows) {
    for (const app::SweepStep& step : row.trials[0].steps) {
      fmt::print("{:>8} {:>9} {:>14.6e} {:>18.6e} {:>16.6e} {:>18.6e}\n", WeightName(row),
                 step.iteration, step.cost, step.reprojection_error, step.prior_position_error,
                 step.prior_rotation_error);
    }
  }
}

std::string ToCsv(const std::vector<app::SweepRow>& rows) {
  std::string text = "weight,trial,pose_error,point_error,iterations,time_ms,status,converged\n";
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
      {"pose_error", sum.pose_error},
      {"pose_error_spread", sum.pose_error_spread},
      {"point_error", sum.point_error},
      {"iterations", sum.iterations},
      {"time_ms", sum.time_ms},
      {"converged", sum.converged}};
  json["trials"] = nlohmann::json::array();
  for (const app::SweepTrial& trial : row.trials) {
    nlohmann::ordered_json t = {
        {"pose_error", trial.errors.pose},       {"point_error", trial.errors.point},
        {"iterations", trial.iterations},        {"time_ms", 1e3 * trial.time_s},
        {"status", ToString(trial.termination)}, {"converged", trial.converged}};
    t["steps"] = nlohmann::json::array();
    for (const app::SweepStep& step : trial.steps) {
      t["steps"].push_back(
          nlohmann::ordered_json{{"iteration", step.iteration},
                                 {"cost", step.cost},
                                 {"reprojection_error", step.reprojection_error},
                                 {"prior_position_error", step.prior_position_error},
                                 {"prior_rotation_error", step.prior_rotation_error}});
    }
    json["trials"].push_back(std::move(t));
  }
  return json;
}

nlohmann::ordered_json ToJson(const std::vector<app::SweepRow>& rows, const Options& o) {
  nlohmann::ordered_json json = {{"pose_noise", o.pose_noise},
                                 {"num_trials", o.trials},
                                 {"seed", o.seed},
                                 {"lm", o.course_stop ? "course" : o.lm},
                                 {"course_stop", o.course_stop}};
  json["rows"] = nlohmann::json::array();
  for (const app::SweepRow& row : rows)
    json["rows"].push_back(ToJson(row));
  return json;
}

int Run(const Options& o) {
  app::SweepOptions options;
  if (Status s = MakeSweepOptions(o, &options); !s.ok()) return app::Refuse(kName, s.message());
  const auto scene = app::LoadScene(o.scene);
  if (!scene.ok()) return app::Refuse(kName, scene.status().message());
  const auto rows = app::RunSweep(*scene, options);
  if (!rows.ok()) return app::Refuse(kName, rows.status().message());

  PrintTable(*rows);
  if (o.verbose) PrintPaths(*rows);
  const auto write = [](const std::string& path, const std::string& text) {
    return path.empty() ? Status() : app::WriteFile(path, text);
  };
  if (Status s = write(o.csv, ToCsv(*rows)); !s.ok()) {
    return app::Refuse(kName, s.message(), app::kExitFailed);
  }
  if (o.json.empty()) return app::kExitOk;
  if (Status s = write(o.json, ToJson(*rows, o).dump(1) + "\n"); !s.ok()) {
    return app::Refuse(kName, s.message(), app::kExitFailed);
  }
  return app::kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli(kDescription, kName);
  cli.footer(kFooter);
  Options options;
  AddOptions(cli, options);
  if (const auto exit_code = app::Parse(cli, argc, argv)) return *exit_code;
  return Run(options);
}
