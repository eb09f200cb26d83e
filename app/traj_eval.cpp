// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Judges an estimated trajectory by a reference.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/version.h"
#include "glissade/eval/absolute_error.h"
#include "glissade/eval/alignment.h"
#include "glissade/eval/relative_error.h"
#include "glissade/io/trajectory.h"
#include "glissade/io/viotracks.h"
#include "page/report_page.h"
#include "page/trajectory_page.h"

namespace {

using namespace glissade;

constexpr const char* kName = "traj_eval";

constexpr const char* kDescription =
    R"(Judges an estimated trajectory by a reference: absolute errors (ATE) after alignment, and relative
errors (RPE) per time and per distance travelled. Formulas: docs/evaluation.md. Or converts it to
another format.)";

constexpr const char* kFooter =
    R"(ESTIMATE and REFERENCE are trajectory files: TUM's (stamp in seconds, px py pz qx qy qz qw),
EuRoC's (comma-separated: stamp in ns, px py pz qw qx qy qz ...) or KITTI's (12 numbers a line, no
stamp: --times or --rate), told apart by their first lines, plain or compressed. REFERENCE may also
be a recording's folder (VIOTRACKS), whose gravity then says what is vertical.

--output writes the estimate as it was read in another format, and needs no REFERENCE: by the end of
the name EuRoC's (.csv) or KITTI's (.kitti), else TUM's; --format says it otherwise.

--align moves the estimate by what its sensors cannot observe, and by no more:
  yaw     position and heading: a camera with an IMU
  se3     position and rotation: a stereo camera
  sim3    and scale: one camera alone
  none    nothing: both are in one world

Examples:
  traj_eval data/flight_odometry.txt.gz data/flight
  traj_eval data/flight_odometry.txt.gz data/flight --align se3 --lengths 2,4,8
  traj_eval estimate.txt truth.csv --align sim3 --json figures.json --report page.html
  traj_eval estimate.txt truth.txt --match nearest --max-difference 0.02
  traj_eval estimate.txt truth.csv --vertical 0,-1,0     y of the reference's world is down
  traj_eval 00.txt poses/00.txt --times sequences/00/times.txt --vertical 0,-1,0
  traj_eval estimate.csv --output estimate.kitti --output-times times.txt

Exit code: 0; 2 where a file or an option makes no sense, or the two cannot be matched or aligned; 1
where a file cannot be written.)";

struct Options {
  std::string estimate, reference;
  std::string align = "yaw", match = "interpolate";
  std::vector<double> vertical;
  double tolerance_s = 0.01, max_gap_s = 1.0, offset_s = 0.0;
  double interval_s = 1.0;
  std::vector<double> lengths_m;
  int every = 1;
  KittiStamps stamps;
  std::string json, report, aligned, output, format, output_times;
};

void AddOptions(app::Program& program, Options& o) {
  CLI::App& cli = program.cli();
  cli.add_option("ESTIMATE", o.estimate, "Trajectory file")->required();
  cli.add_option("REFERENCE", o.reference, "Trajectory file, or folder of a recording");
  app::AddChoice(cli, "--align", &o.align, {"yaw", "se3", "sim3", "none"},
                 "What may be moved (default yaw); see below");
  app::AddNumbers(cli, "--vertical", &o.vertical, -1e3, 1e3,
                  "The vertical, X,Y,Z, in both worlds (default: against the recording's gravity, "
                  "else 0,0,1)");
  app::AddChoice(cli, "--match", &o.match, {"interpolate", "nearest"},
                 "The reference at the estimate's stamps (default interpolate)");
  app::AddNumber(cli, "--max-difference", &o.tolerance_s, 0.0, 1e6,
                 "Nearest: stamps differ by at most so much (s; default 0.01)");
  app::AddNumber(cli, "--max-gap", &o.max_gap_s, 0.0, 1e6,
                 "Interpolate: not over more than that (s; default 1)");
  app::AddNumber(cli, "--time-offset", &o.offset_s, -9e9, 9e9,
                 "Added to the stamps of the estimate (s; default 0)");
  app::AddNumber(cli, "--interval", &o.interval_s, 1e-6, 1e6,
                 "Relative errors over that time, within a tenth of it (s; default 1)");
  app::AddNumbers(
      cli, "--lengths", &o.lengths_m, 1e-6, 1e9,
      "Relative errors over these lengths, increasing (m; default: 100,200,...,800 where "
      "the reference goes 200 m or more, else 5,10,20,40)");
  app::AddInteger(cli, "--every", &o.every, 1, 1000000,
                  "Relative errors from every N-th pose on (default 1)");
  program.AddJson(&o.json);
  program.AddOutput("--report", &o.report, "Write a page to look at (HTML) to FILE");
  program.AddOutputFile("--aligned", &o.aligned, "Write the aligned estimate to FILE (TUM)");
  CLI::Option* times = cli.add_option("--times", o.stamps.times,
                                      "Stamps of KITTI's files: a time in seconds per pose");
  app::AddNumber(cli, "--rate", &o.stamps.rate_hz, 1e-6, 1e9, "The same: poses per second")
      ->excludes(times);
  CLI::Option* output =
      program.AddOutputFile("--output", &o.output, "Write the estimate as it was read to FILE");
  app::AddChoice(cli, "--format", &o.format, {"tum", "euroc", "kitti"},
                 "In which --output is written: tum, euroc or kitti (default: by its name)")
      ->needs(output);
  program
      .AddOutputFile("--output-times", &o.output_times,
                     "KITTI: write the stamps to FILE, which --output has not")
      ->needs(output);
}

std::int64_t Nanoseconds(double seconds) {
  return std::llround(seconds * 1e9);
}

struct Figures {
  std::size_t estimated = 0;
  Vector3 vertical;
  eval::Alignment alignment;
  eval::MatchedTrajectories matched;
  eval::AbsoluteErrors ate;
  Result<eval::TimeRpe> over_time = Status(StatusCode::kInvalidArgument, "");
  Result<eval::DistanceRpe> over_distance = Status(StatusCode::kInvalidArgument, "");
};

/// The reference; sets the vertical where the file knows it.
Result<eval::Trajectory> ReadReference(const std::string& path, const KittiStamps& stamps,
                                       Vector3* vertical) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return ReadTrajectory(path, stamps);
  const auto recording = ReadViotracks(path);
  if (!recording.ok()) return recording.status();
  if (recording->ground_truth.empty()) {
    return Status(StatusCode::kInvalidArgument, path + ": the recording has no ground truth");
  }
  if (recording->gravity.norm() > 0.0) {
    // 0 - x: no -0 in what is written.
    *vertical = Vector3::Zero() - recording->gravity.normalized();
  }
  eval::Trajectory trajectory;
  for (const GroundTruthState& state : recording->ground_truth)
    trajectory.push_back({state.stamp_ns, state.T_w_b});
  return trajectory;
}

eval::AlignmentKind KindOf(const std::string& word) {
  for (const auto kind :
       {eval::AlignmentKind::kYaw, eval::AlignmentKind::kSe3, eval::AlignmentKind::kSim3}) {
    if (word == eval::ToString(kind)) return kind;
  }
  return eval::AlignmentKind::kNone;
}

Result<Figures> Evaluate(const Options& o, const eval::Trajectory& estimate) {
  Figures f;
  f.vertical = Vector3(0.0, 0.0, 1.0);
  const auto reference = ReadReference(o.reference, o.stamps, &f.vertical);
  if (!reference.ok()) return reference.status();
  if (!o.vertical.empty()) f.vertical = Vector3(o.vertical[0], o.vertical[1], o.vertical[2]);
  f.estimated = estimate.size();
  eval::AssociationOptions association;
  association.kind =
      o.match == "nearest" ? eval::AssociationKind::kNearest : eval::AssociationKind::kInterpolated;
  association.tolerance_ns = Nanoseconds(o.tolerance_s);
  association.max_gap_ns = Nanoseconds(o.max_gap_s);
  association.offset_ns = Nanoseconds(o.offset_s);
  auto matched = eval::Associate(estimate, *reference, association);
  if (!matched.ok()) return matched.status();
  f.matched = std::move(matched).value();

  eval::AlignmentOptions alignment;
  alignment.kind = KindOf(o.align);
  alignment.vertical = f.vertical;
  const auto found = eval::Align(f.matched, alignment);
  if (!found.ok()) return found.status();
  f.alignment = *found;
  eval::ApplyAlignment(f.alignment, f.matched.estimate);

  eval::AbsoluteErrorOptions ate;
  ate.vertical = f.vertical;
  const auto errors = eval::ComputeAbsoluteErrors(f.matched, ate);
  if (!errors.ok()) return errors.status();
  f.ate = *errors;
  // These two may have no pair: the others are told all the same.
  eval::TimeRpeOptions time;
  time.interval_ns = Nanoseconds(o.interval_s);
  time.every = o.every;
  f.over_time = eval::RpeOverTime(f.matched, time);
  eval::DistanceRpeOptions distance;
  distance.every = o.every;
  if (!o.lengths_m.empty()) {
    distance.lengths_m = o.lengths_m;
  } else if (eval::PathLength(f.matched.reference) < 200.0) {
    distance.lengths_m = {5.0, 10.0, 20.0, 40.0};
  }
  f.over_distance = eval::RpeOverDistance(f.matched, distance);
  return f;
}

double Duration(const Figures& f) {
  const eval::Trajectory& x = f.matched.estimate;
  return 1e-9 * static_cast<double>(x.back().stamp_ns - x.front().stamp_ns);
}

void PrintRow(const std::string& name, const eval::Statistics& s) {
  app::Print("{:<28} {:>10.4f} {:>10.4f} {:>10.4f} {:>10.4f} {:>8}\n", name, s.rmse, s.mean,
             s.median, s.max, s.count);
}

void Print(const Figures& f, const Options& o) {
  app::Print("{} of {} poses matched, {:.2f} s, {:.2f} m along the reference\n",
             f.matched.estimate.size(), f.estimated, Duration(f),
             eval::PathLength(f.matched.reference));
  const Vector3 turn = so3::Log(Quaternion(f.alignment.T_r_e.q())) * (180.0 / std::numbers::pi);
  const auto t = f.alignment.T_r_e.p();
  app::Print(
      "alignment {}: turned by {:.3f} deg, moved by {:.4f} {:.4f} {:.4f} m, scaled by {:.6f}\n\n",
      o.align, turn.norm(), t[0], t[1], t[2], f.alignment.scale);
  app::Print("{:<28} {:>10} {:>10} {:>10} {:>10} {:>8}\n", "absolute", "rmse", "mean", "median",
             "max", "poses");
  PrintRow("  position [m]", f.ate.translation_m);
  PrintRow("  rotation [deg]", f.ate.rotation_deg);
  PrintRow("  yaw [deg]", f.ate.yaw_deg);
  app::Print("{:<28} {:>10} {:>10} {:>10} {:>10} {:>8}\n", "relative", "rmse", "mean", "median",
             "max", "pairs");
  if (f.over_time.ok()) {
    PrintRow(fmt::format("  over {:g} s: position [m]", o.interval_s), f.over_time->translation_m);
    PrintRow(fmt::format("  over {:g} s: rotation [deg]", o.interval_s), f.over_time->rotation_deg);
  } else {
    app::Print("  {}\n", f.over_time.status().message());
  }
  if (!f.over_distance.ok()) {
    app::Print("  {}\n", f.over_distance.status().message());
    return;
  }
  for (const eval::SegmentErrors& s : f.over_distance->by_length) {
    if (s.pairs.empty()) continue;
    PrintRow(fmt::format("  over {:g} m: position [%]", s.length_m), s.translation_percent);
    PrintRow(fmt::format("  over {:g} m: rot. [deg/m]", s.length_m), s.rotation_deg_per_m);
  }
  PrintRow("  all lengths: position [%]", f.over_distance->translation_percent);
  PrintRow("  all lengths: rot. [deg/m]", f.over_distance->rotation_deg_per_m);
}

using Json = nlohmann::ordered_json;

Json ToJson(const eval::Statistics& s) {
  return {
      {"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median}, {"max", s.max}, {"count", s.count}};
}

Json ToJson(const Figures& f, const Options& o) {
  Json json = app::JsonHeader(kName, o.estimate);
  const double* pose = f.alignment.T_r_e.data;
  json["reference"] = o.reference;
  json["poses"] = f.estimated;
  json["poses_judged"] = f.matched.estimate.size();
  json["duration_s"] = Duration(f);
  json["path_m"] = eval::PathLength(f.matched.reference);
  json["vertical"] = {f.vertical[0], f.vertical[1], f.vertical[2]};
  json["alignment"] = o.align;
  json["aligned_by"] = {{"scale", f.alignment.scale},
                        {"position_m", {pose[0], pose[1], pose[2]}},
                        {"quaternion_xyzw", {pose[3], pose[4], pose[5], pose[6]}}};
  json["ate"] = {{"translation_m", ToJson(f.ate.translation_m)},
                 {"rotation_deg", ToJson(f.ate.rotation_deg)},
                 {"yaw_deg", ToJson(f.ate.yaw_deg)}};
  json["rpe_time"] = nullptr;
  if (f.over_time.ok()) {
    json["rpe_time"] = {{"interval_s", o.interval_s},
                        {"translation_m", ToJson(f.over_time->translation_m)},
                        {"rotation_deg", ToJson(f.over_time->rotation_deg)}};
  }
  json["rpe_distance"] = nullptr;
  if (f.over_distance.ok()) {
    Json lengths = Json::array();
    for (const eval::SegmentErrors& s : f.over_distance->by_length) {
      lengths.push_back({{"length_m", s.length_m},
                         {"translation_percent", ToJson(s.translation_percent)},
                         {"rotation_deg_per_m", ToJson(s.rotation_deg_per_m)}});
    }
    json["rpe_distance"] = {{"translation_percent", ToJson(f.over_distance->translation_percent)},
                            {"rotation_deg_per_m", ToJson(f.over_distance->rotation_deg_per_m)},
                            {"by_length", lengths}};
  }
  return json;
}

TrajectoryFormat OutputFormat(const Options& o) {
  const auto ends_with = [&](const std::string& ending) {
    return o.output.ends_with(ending) || o.output.ends_with(ending + ".gz") ||
           o.output.ends_with(ending + ".bz2");
  };
  if (o.format == "euroc" || (o.format.empty() && ends_with(".csv")))
    return TrajectoryFormat::kEuroc;
  if (o.format == "kitti" || (o.format.empty() && ends_with(".kitti")))
    return TrajectoryFormat::kKitti;
  return TrajectoryFormat::kTum;
}

/// What options ask of each other and of the files.
Status CheckFiles(const Options& o) {
  const auto refused = [](const std::string& what) {
    return Status(StatusCode::kInvalidArgument, what);
  };
  if (o.reference.empty()) {
    if (o.output.empty()) return refused("REFERENCE is required, but for --output alone");
    if (!o.json.empty()) return refused("--json: needs REFERENCE");
    if (!o.report.empty()) return refused("--report: needs REFERENCE");
    if (!o.aligned.empty()) return refused("--aligned: needs REFERENCE");
  }
  if (!o.output_times.empty() && OutputFormat(o) != TrajectoryFormat::kKitti)
    return refused("--output-times: only KITTI's files are without stamps");
  if (o.stamps.times.empty() && o.stamps.rate_hz == 0.0) return {};
  for (const std::string& path : {o.estimate, o.reference}) {
    const auto format = FindTrajectoryFormat(path);
    // What cannot be read is told when it is read; a folder has its own stamps.
    if (format.ok() ? format.value() == TrajectoryFormat::kKitti : path == o.estimate) return {};
  }
  return refused("--times and --rate: neither file is one of KITTI's, the others have stamps");
}

/// The figures of the page, by the names that vio_replay gives them.
Json PageFigures(const Figures& f, const Options& o) {
  Json figures = {{"frames", f.matched.estimate.size()},
                  {"ate_m", f.ate.translation_m.rmse},
                  {"ate_yaw_deg", f.ate.yaw_deg.rmse},
                  {"alignment", o.align},
                  {"path_m", eval::PathLength(f.matched.reference)},
                  {"duration_s", Duration(f)},
                  {"initialized_at_s", nullptr}};
  if (o.align == "sim3") {
    figures["scale_error_percent"] = 100.0 * (1.0 / f.alignment.scale - 1.0);
  }
  if (f.over_time.ok() && o.interval_s == 1.0) {
    figures["rpe_1s_m"] = f.over_time->translation_m.rmse;
  }
  if (f.over_distance.ok()) {
    figures["rpe_percent"] = f.over_distance->translation_percent.mean;
    if (o.lengths_m.size() == 1) figures["rpe_length_m"] = o.lengths_m[0];
  }
  return figures;
}

app::Outcome Run(const Options& o) {
  const bool zero = o.vertical == std::vector<double>{0.0, 0.0, 0.0};
  if (!o.vertical.empty() && (o.vertical.size() != 3 || zero)) {
    return app::BadInput("--vertical: must be three numbers X,Y,Z, not all 0");
  }
  for (std::size_t k = 1; k < o.lengths_m.size(); ++k) {
    if (!(o.lengths_m[k] > o.lengths_m[k - 1])) {
      return app::BadInput("--lengths: must increase");
    }
  }
  if (!o.report.empty()) {
    if (Status s = app::CheckReportPage(); !s.ok()) return app::BadInput(s);
  }
  if (Status s = CheckFiles(o); !s.ok()) return app::BadInput(s);
  const auto estimate = ReadTrajectory(o.estimate, o.stamps);
  if (!estimate.ok()) return app::BadInput(estimate.status());
  const auto convert = [&] {
    return WriteTrajectory(*estimate, o.output, OutputFormat(o), o.output_times);
  };
  if (o.reference.empty()) {
    const Status converted = convert();
    if (converted.ok()) app::Print("{}: {} poses\n", o.output, estimate->size());
    return converted.ok() ? app::Outcome() : app::Failed(converted);
  }
  const auto figures = Evaluate(o, *estimate);
  if (!figures.ok()) return app::BadInput(figures.status());
  Print(*figures, o);
  Status written;
  if (!o.output.empty()) written = convert();
  if (written.ok() && !o.aligned.empty())
    written = WriteTumTrajectory(figures->matched.estimate, o.aligned);
  if (written.ok() && !o.report.empty()) {
    app::TrajectoryPage page;
    page.estimate = o.estimate;
    page.reference = o.reference;
    page.made_by = app::VersionText(kName);
    page.figures = PageFigures(*figures, o);
    written = app::WriteReportPage(app::PageOf(page, figures->matched), o.report);
  }
  if (written.ok() && !o.json.empty()) written = app::WriteJson(o.json, ToJson(*figures, o), 2);
  return written.ok() ? app::Outcome() : app::Failed(written);
}

}  // namespace

int main(int argc, char** argv) {
  return app::Program(kName, kDescription, kFooter).Main<Options>(argc, argv, AddOptions, Run);
}
