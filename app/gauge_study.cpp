// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Reproduces "On the Comparison of Gauge Freedom Handling in Optimization-Based Visual-Inertial
// State Estimation" (Z. Zhang, G. Gallego, D. Scaramuzza, RA-L 2018).
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/interrupt.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/solver_options.h"
#include "common/version.h"
#include "studies/gauge_report.h"
#include "studies/vio_segment.h"

namespace {

using namespace glissade;

constexpr const char* kName = "gauge_study";

constexpr const char* kDescription =
    R"(What to do with the four directions that visual-inertial measurements leave open: hold them
(fixed), leave them to the damping (free), or pull them with a prior? Compares accuracy, iterations,
time and covariance on simulated flights (sine, arc, rec; points on planes or random) and, with
--vio, on recordings.)";

constexpr const char* kFooter =
    R"(Errors are root mean squares over the keyframes after alignment (yaw and translation) of the
first pose, means over the trials; iterations and times are medians. Solves end by the rule of the
paper, a relative decrease of the cost under 1e-6; the first five trials are also run until they
converge, and compared to the fixed gauge's result: cost, and largest difference of position,
rotation, velocity.

Trials run two at a time, each on one thread; --jobs 1 if times matter. The same seed gives the
same numbers, times apart, for any number of jobs. docs/gauge_study.md has all parameters of the
worlds.

Examples:
  gauge_study
  gauge_study --trials 50 --vio data/flight --vio-start 1 --json study.json
  scripts/plot_gauge_study.py study.json docs/images   draws it

After Ctrl-C the configurations until then are shown and written.

Exit code: 0; 130 after Ctrl-C; 2 where an option or a recording makes no sense; 1 where a solve
fails.)";

struct Options {
  app::GaugeStudyOptions study;
  app::SolverOptions solver;
  std::string sweep = "sine-plane";
  std::vector<std::string> vio;
  app::VioSegmentOptions segment;
  std::string json, csv;
};

struct Configuration {
  sim::TrajectoryKind trajectory;
  sim::PointLayout points;
};

constexpr Configuration kConfigurations[] = {
    {sim::TrajectoryKind::kSine, sim::PointLayout::kPlane},
    {sim::TrajectoryKind::kSine, sim::PointLayout::kRandom},
    {sim::TrajectoryKind::kArc, sim::PointLayout::kPlane},
    {sim::TrajectoryKind::kArc, sim::PointLayout::kRandom},
    {sim::TrajectoryKind::kRec, sim::PointLayout::kPlane},
    {sim::TrajectoryKind::kRec, sim::PointLayout::kRandom}};

std::string NameOf(const Configuration& c, char between) {
  return std::string(sim::ToString(c.trajectory)) + between + std::string(sim::ToString(c.points));
}

Result<app::ProblemSource> SourceOf(const Configuration& c, std::uint64_t seed) {
  sim::ViWorldOptions options;
  options.trajectory = c.trajectory;
  options.points = c.points;
  options.seed = seed;
  auto world = sim::MakeViWorld(options);
  if (!world.ok()) return world.status();
  return app::Simulated(std::move(world).value(), seed);
}

void AddOptions(app::Program& program, Options& o) {
  CLI::App& cli = program.cli();
  std::vector<std::string> names;
  for (const Configuration& c : kConfigurations)
    names.push_back(NameOf(c, '-'));
  app::AddInteger(
      cli, "--trials", &o.study.trials, 1, 100000,
      "Repetitions of everything random: measurements and starts per configuration (default 50)");
  app::AddSeed(cli, &o.study.seed, "worlds, noise and starts");
  app::AddInteger(cli, "--jobs", &o.study.num_threads, 1, 1024, "Trials side by side (default 2)");
  app::AddLinearSolver(cli, &o.solver);
  app::AddChoice(cli, "--sweep", &o.sweep, names,
                 "Configuration of the weight sweep, the paths and the covariance (default "
                 "sine-plane)");
  cli.add_option("--vio", o.vio, "A recording (VIOTRACKS folder); may be repeated")
      ->type_name("DIR");
  app::AddNumber(cli, "--vio-start", &o.segment.start_s, 0.0, 1e9,
                 "Where its segment begins (s, default 40)");
  app::AddInteger(cli, "--vio-keyframes", &o.segment.num_keyframes, 2, 1000,
                  "Keyframes of the segment (default 30)");
  program.AddOutput("--csv", &o.csv, "Write one line per trial (CSV) to FILE");
  program.AddJson(&o.json);
}

/// Reads all recordings before anything is computed.
Result<std::vector<sim::ViProblem>> ReadSegments(const Options& o) {
  std::vector<sim::ViProblem> segments;
  for (const std::string& folder : o.vio) {
    const auto recording = ReadViotracks(folder);
    if (!recording.ok()) return recording.status();
    auto segment = app::MakeVioSegment(*recording, o.segment);
    if (!segment.ok()) {
      return Status(segment.status().code(), folder + ": " + segment.status().message());
    }
    segments.push_back(std::move(segment).value());
  }
  return segments;
}

Status RunSimulated(const Configuration& sweep, app::GaugeStudy* study, app::ProgressBar* bar) {
  for (const Configuration& c : kConfigurations) {
    bar->SetLabel(NameOf(c, ' '));
    const auto source = SourceOf(c, study->options.seed);
    if (!source.ok()) return source.status();
    auto result = app::RunConfiguration(*source, study->options, bar);
    if (!result.ok()) return result.status();
    result->trajectory = sim::ToString(c.trajectory);
    result->points = sim::ToString(c.points);
    study->configurations.push_back(std::move(result).value());
  }
  study->sweep_configuration = NameOf(sweep, ' ');
  bar->SetLabel("weights, " + study->sweep_configuration);
  const auto source = SourceOf(sweep, study->options.seed);
  if (!source.ok()) return source.status();
  auto weights = app::RunWeights(*source, study->options, bar);
  if (!weights.ok()) return weights.status();
  study->weights = std::move(weights).value();
  auto paths = app::RunPaths(*source, study->options);
  if (!paths.ok()) return paths.status();
  study->paths = std::move(paths).value();
  bar->SetLabel("covariance");
  const auto problem = (*source)(0);
  if (!problem.ok()) return problem.status();
  auto covariance = app::CompareCovariances(*problem);
  if (!covariance.ok()) return covariance.status();
  study->covariance.push_back(std::move(covariance).value());
  return {};
}

Status RunReal(const Options& o, const std::vector<sim::ViProblem>& segments,
               app::GaugeStudy* study, app::ProgressBar* bar) {
  for (std::size_t k = 0; k < segments.size(); ++k) {
    app::GaugeRealResult real;
    const auto path = std::filesystem::path(o.vio[k]).lexically_normal();
    real.dataset =
        path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
    bar->SetLabel(real.dataset);
    const auto source = [&](int trial) -> Result<sim::ViProblem> {
      return app::WithStart(
          segments[k], {},
          std::uint64_t{study->options.seed} * 1000003u + static_cast<std::uint64_t>(trial));
    };
    auto result = app::RunConfiguration(source, study->options, bar);
    if (!result.ok()) return result.status();
    real.configuration = std::move(result).value();
    auto covariance = app::CompareCovariances(source(0).value());
    if (!covariance.ok()) return covariance.status();
    real.covariance = std::move(covariance).value();
    study->real.push_back(std::move(real));
  }
  return {};
}

app::Outcome Run(const Options& o) {
  const auto segments = ReadSegments(o);
  if (!segments.ok()) return app::BadInput(segments.status());

  app::GaugeStudy study;
  study.options = o.study;
  study.options.linear_solver = o.solver.Chosen().linear_solver_type;
  study.options.weights = {0, 3, 7, 10, 50, 100, 300, 500, 1e3, 5e3, 1e5, 5e6, 1e8};
  study.options.path_weights = {0, 7, 100, 500, 1e8};
  const Configuration* sweep = nullptr;
  for (const Configuration& c : kConfigurations) {
    if (o.sweep == NameOf(c, '-')) sweep = &c;
  }
  Status status;
  {
    app::ProgressBar bar(o.study.trials * (7 + static_cast<int>(o.vio.size())));
    status = RunSimulated(*sweep, &study, &bar);
    if (status.ok()) status = RunReal(o, *segments, &study, &bar);
  }
  if (!status.ok() && !app::Interrupted()) return app::Failed(status);

  app::PrintStudy(study);
  Status written;
  if (!o.csv.empty()) written = app::WriteFile(o.csv, ToCsv(study));
  if (written.ok() && !o.json.empty()) {
    nlohmann::ordered_json json = app::JsonHeader(kName, "");
    json["recordings"] = o.vio;
    json.update(ToJson(study));
    written = app::WriteJson(o.json, json, -1);
  }
  return written.ok() ? app::Outcome{} : app::Failed(written);
}

}  // namespace

int main(int argc, char** argv) {
  return app::Program(kName, kDescription, kFooter).Main<Options>(argc, argv, AddOptions, Run);
}
