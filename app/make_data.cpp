// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Makes the files of data/, and larger ones of the same kind.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/status_line.h"
#include "glissade/io/bal.h"
#include "glissade/io/trajectory.h"
#include "glissade/io/viotracks.h"
#include "glissade/io/viowin.h"
#include "glissade/lie/so3.h"
#include "glissade/sim/bal_scene.h"
#include "glissade/sim/city.h"
#include "glissade/sim/noise_source.h"
#include "glissade/sim/recording.h"
#include "glissade/sim/windows.h"

namespace {

using namespace glissade;

constexpr const char* kName = "make_data";

constexpr const char* kDescription =
    R"(Simulates data and writes them in the formats that the other programs read: sliding windows
(VIOWIN), a recording of a stereo camera with an IMU (VIOTRACKS), what a drifting odometry might have
made of that recording's flight (TUM trajectory), or a bundle adjustment problem (BAL): of cameras on
a ring around a cloud of points, or of a city of any size.)";

constexpr const char* kFooter =
    R"(The same options give the same numbers, to the rounding of the machine's log, sin and cos. The
formats are described in docs/formats.md, the files in data/ in data/README.md; these are made by
scripts/make_data.sh.

Examples:
  make_data windows win10.txt.gz                   4 windows of 10 keyframes
  make_data windows win50.txt.gz --keyframes 50 --windows 4 --seed 50
  make_data windows win11m.txt.gz --keyframes 11 --hosted-by-first 60
  make_data recording flight                       12 s, written to the folder flight
  make_data odometry odometry.txt                  that flight as an odometry may see it
  make_data bal ring.txt.gz --cameras 100 --points 5000
  make_data city city.bbal --cameras 1000          578 000 observations, in binary

Exit code: 0; 2 where an option makes no sense; 1 where a file cannot be written.)";

struct Options {
  std::string kind, output;
  std::uint32_t seed = 1;
  int windows = 4;
  int cameras = 0;  // 0: what is usual for the kind
  sim::WindowMakerOptions window;
  sim::RecordingOptions recording;
  sim::BalSceneOptions bal;
  sim::CityOptions city;
};

void AddOptions(app::Program& program, Options& o) {
  CLI::App& cli = program.cli();
  app::AddChoice(cli, "KIND", &o.kind, {"windows", "recording", "odometry", "bal", "city"},
                 "What is made")
      ->required();
  cli.add_option("OUTPUT", o.output,
                 "File (.txt, .txt.gz, .txt.bz2; bal, city: .bbal), or folder of a recording")
      ->required();
  app::AddSeed(cli, &o.seed, "everything; windows take this one and the next");
  app::AddInteger(cli, "--windows", &o.windows, 1, 10000, "Windows in the file (default 4)");
  app::AddInteger(cli, "--keyframes", &o.window.num_keyframes, 2, 1000,
                  "Keyframes of a window (default 10)");
  app::AddInteger(cli, "--landmarks", &o.window.landmarks_per_keyframe, 1, 10000,
                  "Landmarks of a window, per keyframe (default 25)");
  app::AddInteger(cli, "--hosted-by-first", &o.window.hosted_by_first, 0, 100000,
                  "At least N landmarks are hosted by the first keyframe (default 0)");
  app::AddNumber(cli, "--length", &o.recording.world.length_m, 1.0, 1e4,
                 "Length of a simulated flight, one lap (m; default 15)");
  app::AddInteger(cli, "--cameras", &o.cameras, 3, 20000,
                  "Cameras of a bundle adjustment (default 16, of a city 200)");
  app::AddInteger(cli, "--points", &o.bal.num_points, 1, 10000000,
                  "Points to be seen, of a bundle adjustment (default 300)");
  app::AddNumber(cli, "--outliers", &o.city.outlier_share, 0.0, 0.5,
                 "Part of a city's observations that are anywhere in the image (default 0)");
}

app::Outcome MakeWindows(Options o) {
  o.window.min_track = std::min(o.window.min_track, o.window.num_keyframes);
  std::vector<ViowinWindow> windows;
  for (int k = 0; k < o.windows; ++k) {
    auto window = sim::MakeWindow(o.window, o.seed + static_cast<std::uint64_t>(k));
    if (!window.ok()) return app::BadInput(window.status());
    windows.push_back(std::move(window).value());
  }
  if (Status s = WriteViowin(windows, o.output); !s.ok()) return app::Failed(s);
  app::Print("{}: {} windows of {} keyframes, {} landmarks, {} IMU terms\n", o.output,
             windows.size(), windows[0].keyframes.size(), windows[0].landmarks.size(),
             windows[0].imu.size());
  return {};
}

app::Outcome MakeRecording(Options o) {
  o.recording.seed = o.recording.world.seed = o.seed;
  const auto recording = sim::MakeRecording(o.recording);
  if (!recording.ok()) return app::BadInput(recording.status());
  if (Status s = WriteViotracks(*recording, o.output); !s.ok()) return app::Failed(s);
  app::Print("{}: {} frames, {} observations, {} IMU samples\n", o.output, recording->frames.size(),
             recording->tracks.size(), recording->imu.size());
  return {};
}

/// The motion from frame to frame with noise in it, added up in a world of its own: 0.5 % of the
/// way and 0.02 deg a frame, and its yaw and origin are others.
app::Outcome MakeOdometry(Options o) {
  constexpr std::uint64_t kOdometryStream = 71;
  o.recording.seed = o.recording.world.seed = o.seed;
  const auto recording = sim::MakeRecording(o.recording);
  if (!recording.ok()) return app::BadInput(recording.status());
  sim::NoiseSource noise(o.seed, kOdometryStream);
  eval::Trajectory trajectory;
  Pose T_o_b(so3::ExpQuaternion({0.0, 0.0, noise.Uniform(-1.0, 1.0)}), Vector3::Zero());
  Pose before;
  for (const GroundTruthState& state : recording->ground_truth) {
    if (trajectory.empty()) {
      T_o_b = T_o_b * Pose(Quaternion(state.T_w_b.q()), Vector3::Zero());
    } else {
      Pose step = before.Inverse() * state.T_w_b;
      step.p() *= 1.005;
      T_o_b = T_o_b * step * Pose(so3::ExpQuaternion(noise.Normal3(3.5e-4)), Vector3::Zero());
    }
    T_o_b.Normalize();
    before = state.T_w_b;
    trajectory.push_back({state.stamp_ns, T_o_b});
  }
  if (Status s = WriteTumTrajectory(trajectory, o.output); !s.ok()) return app::Failed(s);
  app::Print("{}: {} poses, {:.2f} m\n", o.output, trajectory.size(), eval::PathLength(trajectory));
  return {};
}

app::Outcome WriteProblem(const Result<BalProblem>& problem, const std::string& path,
                          app::StatusLine* status) {
  status->Clear();
  if (!problem.ok()) return app::BadInput(problem.status());
  const auto progress = [&](double part) { status->ShowPart("writing " + path, part); };
  const Status s = WriteBal(*problem, path, progress);
  status->Clear();
  if (!s.ok()) return app::Failed(s);
  app::Print("{}: {} cameras, {} points, {} observations\n", path, problem->cameras.size(),
             problem->points.size(), problem->observations.size());
  return {};
}

app::Outcome MakeBal(Options o) {
  app::StatusLine status;
  o.bal.seed = o.seed;
  if (o.cameras != 0) o.bal.num_cameras = o.cameras;
  return WriteProblem(sim::MakeBalScene(o.bal), o.output, &status);
}

app::Outcome MakeCity(Options o) {
  app::StatusLine status;
  o.city.seed = o.seed;
  if (o.cameras != 0) o.city.num_cameras = o.cameras;
  status.ShowNow(fmt::format("making a city of {} cameras", o.city.num_cameras));
  return WriteProblem(sim::MakeCity(o.city), o.output, &status);
}

}  // namespace

int main(int argc, char** argv) {
  const auto make = [](const Options& options) {
    if (options.kind == "windows") return MakeWindows(options);
    if (options.kind == "odometry") return MakeOdometry(options);
    if (options.kind == "city") return MakeCity(options);
    return options.kind == "bal" ? MakeBal(options) : MakeRecording(options);
  };
  return app::Program(kName, kDescription, kFooter).Main<Options>(argc, argv, AddOptions, make);
}
