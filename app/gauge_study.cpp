// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Reproduces "On the Comparison of Gauge Freedom Handling in Optimization-Based Visual-Inertial
// State Estimation" (Z. Zhang, G. Gallego, D. Scaramuzza, RA-L 2018).
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/cli.h"
#include "common/gauge_report.h"
#include "common/output_file.h"
#include "common/vio_segment.h"

namespace {

using namespace glissade;

constexpr const char* kName = "gauge_study";

constexpr const char* kDescription =
    R"(What to do with the four directions that visual-inertial measurements leave open: hold them (fixed),
leave them to the damping (free), or pull them with a prior? Compares accuracy, iterations, time and
covariance on simulated flights (sine, arc, rec; points on planes or random) and, with --vio, on
recordings.)";

constexpr const char* kFooter =
    R"(Errors are root mean squares over the keyframes after alignment (yaw and translation) of the first
pose, means over the trials; iterations and times are medians. Solves end by the rule of the paper, a
relative decrease of the cost under 1e-6; the first five trials are also run until they converge, and
compared to the fixed gauge's result: cost, and largest difference of position, rotation, velocity.

Trials run two at a time, each on one thread; --threads 1 if times matter. The same seed gives the same
numbers, times apart, for any number of threads. docs/gauge_study.md has all parameters of the worlds.

Examples:
  gauge_study
  gauge_study --trials 50 --vio data/euroc_v101_semi --vio data/euroc_mh05_semi --json study.json
  scripts/plot_gauge_study.py study.json docs/images   draws it

Exit code: 0, or 2 where an option or a recording makes no sense, or 1 where a solve fails.)";

struct Options {
  int trials = 50;
  std::int64_t seed = 1;
  int threads = 2;
  std::string sweep = "sine-plane";
  std::vector<std::string> vio;
  double vio_start = 40.0;
  int vio_keyframes = 30;
  std::string json, csv;
};

void AddOptions(CLI::App& app, Options& o) {
  app.add_option("--trials", o.trials, "Measurements and starts per configuration (default 50)")
      ->type_name("N");
  app.add_option("--seed", o.seed, "Seed of worlds, noise and starts (default 1)")->type_name("N");
  app.add_option("--threads", o.threads, "Trials side by side (default 2)")->type_name("N");
  app.add_option("--sweep", o.sweep,
                 "Configuration of the weight sweep, the paths and the covariance (default "
                 "sine-plane)")
      ->type_name("NAME");
  app.add_option("--vio", o.vio, "A recording (VIOTRACKS folder); may be given several times")
      ->type_name("DIR");
  app.add_option("--vio-start", o.vio_start, "Where its segment begins (s, default 40)")
      ->type_name("S");
  app.add_option("--vio-keyframes", o.vio_keyframes, "Keyframes of the segment (default 30)")
      ->type_name("N");
  app.add_option("--csv", o.csv, "Write one line per method and trial to FILE")->type_name("FILE");
  app.add_option("--json", o.json, "Write everything to FILE")->type_name("FILE");
}

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

Status CheckOptions(const Options& o, const Configuration** sweep) {
  for (const Configuration& c : kConfigurations) {
    if (o.sweep == NameOf(c, '-')) *sweep = &c;
  }
  if (*sweep == nullptr) {
    return {StatusCode::kInvalidArgument, "--sweep: there is no configuration " + o.sweep};
  }
  return app::FirstError({
      app::CheckRange("--trials", o.trials, 1, 100000),
      app::CheckRange("--seed", o.seed, 0, 4294967295),
      app::CheckRange("--threads", o.threads, 1, 256),
      app::CheckAtLeast("--vio-start", o.vio_start, 0.0),
      app::CheckRange("--vio-keyframes", o.vio_keyframes, 2, 1000),
      app::CheckDifferent("--csv", o.csv, "--json", o.json),
      app::CheckWritable("--csv", o.csv),
      app::CheckWritable("--json", o.json),
  });
}

/// Reads all recordings before anything is computed.
Result<std::vector<sim::ViProblem>> ReadSegments(const Options& o) {
  std::vector<sim::ViProblem> segments;
  app::VioSegmentOptions options;
  options.start_s = o.vio_start;
  options.num_keyframes = o.vio_keyframes;
  for (const std::string& folder : o.vio) {
    const auto recording = ReadViotracks(folder);
    if (!recording.ok()) return recording.status();
    auto segment = app::MakeVioSegment(*recording, options);
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
      return app::WithStart(segments[k], {},
                            study->options.seed * 1000003u + static_cast<std::uint64_t>(trial));
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

int Run(const Options& o) {
  const Configuration* sweep = nullptr;
  if (Status s = CheckOptions(o, &sweep); !s.ok()) return app::Refuse(kName, s.message());
  const auto segments = ReadSegments(o);
  if (!segments.ok()) return app::Refuse(kName, segments.status().message());

  app::GaugeStudy study;
  study.options.trials = o.trials;
  study.options.seed = static_cast<std::uint64_t>(o.seed);
  study.options.num_threads = o.threads;
  study.options.weights = {0, 3, 7, 10, 50, 100, 300, 500, 1e3, 5e3, 1e5, 5e6, 1e8};
  study.options.path_weights = {0, 7, 100, 500, 1e8};
  Status status;
  {
    app::ProgressBar bar(o.trials * (7 + static_cast<int>(o.vio.size())));
    status = RunSimulated(*sweep, &study, &bar);
    if (status.ok()) status = RunReal(o, *segments, &study, &bar);
  }
  if (!status.ok()) return app::Refuse(kName, status.message(), app::kExitFailed);

  app::PrintStudy(study);
  const auto write = [](const std::string& path, const std::string& text) {
    return path.empty() ? Status() : app::WriteFile(path, text);
  };
  if (Status s = write(o.csv, ToCsv(study)); !s.ok()) {
    return app::Refuse(kName, s.message(), app::kExitFailed);
  }
  if (o.json.empty()) return app::kExitOk;
  if (Status s = write(o.json, ToJson(study)); !s.ok()) {
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
