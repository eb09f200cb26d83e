// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// From images and an IMU to a trajectory: a front end before a sliding window.
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/interrupt.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/status_line.h"
#include "common/version.h"
#include "glissade/io/trajectory.h"
#include "page/report_page.h"
#include "replay/fault.h"
#include "replay/report.h"
#include "run/image_source.h"
#include "run/run_output.h"
#include "run/vio_session.h"

namespace glissade::app {
namespace {

constexpr const char* kName = "vio_run";

constexpr const char* kDescription =
    R"(From a recording of images (and an IMU) to a trajectory: follows features through the images,
hands them to a sliding-window estimator, and says how far its estimates are from the truth, how long
they took, and what happened.)";

constexpr const char* kFooter =
    R"(DIR is a recording in the layout of EuRoC or TUM-VI (mav0/cam0, perhaps cam1 and imu0, each with
its data.csv and sensor.yaml) or of KITTI odometry (image_0, image_1, calib.txt, times.txt). With one
camera there must be an IMU. The truth, where the recording has it, is for judging alone.

The estimate of a frame is what the window said right after it. Errors are those of vio_replay --help.
Times are of one thread, without the decoding of image files; while it runs they are those of contrast,
track, reject, detect, stereo (with two cameras) and window. --realtime hands frames over at their
own pace and loses those that come while nobody asks, as a camera does.

Kinds of --fault: dropped (every second frame), repeated (every second frame is the one before),
out-of-order (in pairs), black, bright (overexposed), blurred, covered (dark, with noise).

Examples:
  vio_run MH_05                                    stereo and IMU
  vio_run MH_05 --mono --output mh05.tum --report mh05.html
  vio_run MH_05 --start 5 --seconds 10 --json -    part of it
  vio_run MH_05 --fault covered@8..10              the camera is covered for 2 s
  vio_run --print-config > my.yaml                 all that can be set, with what it means
  vio_run MH_05 --config my.yaml
  vio_run MH_05 --save-tracks TRACKS               then: vio_replay TRACKS
  vio_run MH_05 --rerun - | scripts/rerun_view.py  watch it

Exit code: 0; 130 after Ctrl-C; 2 where the recording or an option makes no sense; 1 where no first
state was found or an image could not be read.)";

struct Settings {
  std::string folder, config, out, states, json, report, rerun, save_tracks;
  bool print_config = false, mono = false, realtime = false, wall = false;
  double rpe_length_m = 0.0;
  ImageSourceOptions source;
};

void AddOptions(Program& program, Settings& s) {
  CLI::App& cli = program.cli();
  cli.add_option("DIR", s.folder, "Folder of a recording of images");
  cli.add_flag("--mono", s.mono, "The first camera only");
  cli.add_option("--config", s.config, "Settings (YAML); see --print-config")->type_name("FILE");
  cli.add_flag("--print-config", s.print_config,
               "Print all settings with what they mean, and exit");
  AddNumber(cli, "--start", &s.source.start_s, 0.0, 1e9,
            "Begin so long after the recording does (s; default 0)");
  AddNumber(cli, "--seconds", &s.source.seconds, 0.0, 1e9,
            "End so long after that (s; default: all)");
  cli.add_flag("--realtime", s.source.realtime,
               "At the pace of the camera, losing frames like one");
  AddFaults(cli, ParseImageFault, &s.source.faults);
  AddNumber(cli, "--rpe-length", &s.rpe_length_m, 0.01, 1e6,
            "Of the pieces for RPE in percent (m; default: by the way's length)");
  cli.add_flag("--wall", s.wall, "Times of the clock on the wall");
  program.AddOutputFile("--output,--out", &s.out, "Write the trajectory (TUM) to FILE");
  program.AddOutput("--states", &s.states, "Write states, sigmas, window sizes (CSV) to FILE");
  program.AddJson(&s.json);
  program.AddOutput("--report", &s.report, "Write a page to look at (HTML) to FILE");
  program.AddOutput("--rerun", &s.rerun, "Write what scripts/rerun_view.py shows to FILE");
  program.AddOutputPath("--save-tracks", &s.save_tracks,
                        "Write the tracks (VIOTRACKS) to PATH, a folder, for vio_replay");
}

/// Writes lines as they come; a reader that goes away ends no run.
class LineStream {
 public:
  Status Open(const std::string& path) {
    if (path.empty()) return {};
    file_ = path == "-" ? stdout : std::fopen(path.c_str(), "w");
    if (file_ != nullptr) return {};
    return {StatusCode::kIoError, path + ": cannot be written"};
  }
  ~LineStream() {
    if (file_ != nullptr && file_ != stdout) std::fclose(file_);
  }
  LineStream() = default;
  LineStream(const LineStream&) = delete;
  LineStream& operator=(const LineStream&) = delete;
  void Write(const std::string& line) {
    if (file_ == nullptr || ended_) return;
    const bool written =
        std::fwrite(line.data(), 1, line.size(), file_) == line.size() && std::fflush(file_) == 0;
    if (written) return;
    ended_ = true;
    if (errno != EPIPE) failure_ = std::strerror(errno);
  }
  [[nodiscard]] Status status() const {
    if (failure_.empty()) return {};
    return {StatusCode::kIoError, "--rerun: cannot be written: " + failure_};
  }

 private:
  std::FILE* file_ = nullptr;
  bool ended_ = false;
  std::string failure_;
};

Status WriteAll(const Settings& s, const CausalRun& run, const VioSession& session,
                const nlohmann::ordered_json& json, const std::optional<TrajectoryErrors>& errors,
                bool has_imu) {
  if (!s.out.empty()) {
    if (Status st = WriteTumTrajectory(TrajectoryOf(run), s.out); !st.ok()) return st;
  }
  if (!s.states.empty()) {
    if (Status st = WriteFile(s.states, StatesCsv(run)); !st.ok()) return st;
  }
  if (!s.json.empty()) {
    if (Status st = WriteJson(s.json, json, 2); !st.ok()) return st;
  }
  if (!s.save_tracks.empty()) {
    if (Status st = WriteViotracks(session.tracks(), s.save_tracks); !st.ok()) return st;
  }
  if (s.report.empty()) return {};
  std::string title = std::filesystem::weakly_canonical(s.folder).filename().string();
  title.append(session.tracker().cameras().size() > 1 ? ", stereo" : ", one camera");
  title.append(has_imu ? " and IMU" : "");
  return WriteReportPage(ReportData({title, s.folder, session, run, errors, json, has_imu}),
                         s.report);
}

/// Whether images are of the size that the calibration says.
Status CheckSizes(const SourceFrame& frame, const vision::ImageRecording& recording) {
  for (std::size_t k = 0; k < frame.images.size(); ++k) {
    const vision::Image& image = frame.images[k];
    const vision::Camera& camera = recording.cameras[k];
    if (image.pixels.empty() || (image.width == camera.width && image.height == camera.height)) {
      continue;
    }
    return {StatusCode::kInvalidArgument,
            fmt::format("{}: is {} x {} px, the calibration says {} x {}",
                        recording.frames[frame.index].files[k], image.width, image.height,
                        camera.width, camera.height)};
  }
  return {};
}

Outcome Run(Settings& s) {
  // What cannot be decoded is a status, and needs no second message.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  cv::setNumThreads(1);
  RunConfig config;
  if (!s.config.empty()) {
    if (const Status st = ReadConfig(s.config, &config); !st.ok()) return BadInput(st);
  }
  config.mono = config.mono || s.mono;
  if (s.print_config) {
    Print("{}", ConfigText(config));
    return {};
  }
  if (s.folder.empty()) return BadInput("DIR is required (see --help)");
  if (!s.report.empty()) {
    if (const Status st = CheckReportPage(); !st.ok()) return BadInput(st);
  }
  const auto recording = vision::ReadImageRecording(s.folder, config.mono ? 1 : 2);
  if (!recording.ok()) return BadInput(recording.status());
  auto window = WindowOptions(*recording, config);
  if (!window.ok()) return BadInput(s.folder + ": " + window.status().message());
  const bool has_imu = window->imu_noise.has_value();
  ImageSource source(*recording, s.source);
  if (source.begin() == source.end()) return BadInput(s.folder + ": no frames after --start");
  auto frame = source.Next();
  if (!frame.ok()) return BadInput(frame.status());
  if (frame->has_value()) {
    if (const Status st = CheckSizes(**frame, *recording); !st.ok()) return BadInput(st);
  }
  LineStream rerun;
  if (const Status st = rerun.Open(s.rerun); !st.ok()) return BadInput(st);
  if (!s.rerun.empty()) std::signal(SIGPIPE, SIG_IGN);

  RunSettings run_settings;
  run_settings.budget = config.budget;
  run_settings.covariance = !s.states.empty() || !s.report.empty();
  run_settings.wall_clock = s.wall;
  SessionOutputs outputs;
  outputs.landmarks = !s.report.empty() || !s.rerun.empty();
  outputs.thumbnails = s.report.empty() ? 0 : 12;
  outputs.seconds = SecondsBetween(recording->frames[source.begin()].stamp_ns,
                                   recording->frames[source.end() - 1].stamp_ns);
  outputs.tracks = !s.save_tracks.empty();
  VioSession session(*recording, config, run_settings, std::move(window).value(), outputs,
                     source.begin());
  if (const Status st = session.tracker().Validate(); !st.ok()) {
    return BadInput(s.folder + ": " + st.message());
  }
  {
    StatusLine line;
    for (; frame.ok() && frame->has_value() && !Interrupted(); frame = source.Next()) {
      session.Take(**frame);
      line.Show(session.StatusText());
      if (!s.rerun.empty()) {
        rerun.Write(RerunLine(session, recording->frames[(*frame)->index].files[0]));
      }
    }
  }
  const CausalRun run = session.Finish();
  std::optional<TrajectoryErrors> errors;
  if (!recording->ground_truth.empty()) {
    errors = Judge(TrajectoryOf(run), ReferenceOf(session.tracks()), {has_imu, s.rpe_length_m});
  }
  PrintRun(run, errors);
  if (s.source.realtime) Print("{:>9}  frames lost for want of time\n", source.dropped());
  PrintSession(session);
  std::fflush(TextStream());

  nlohmann::ordered_json json = JsonHeader(kName, s.folder);
  AddRun(run, errors, &json);
  json["policy"] = config.window.policy;
  json["cameras"] = session.tracker().cameras().size();
  json["imu"] = has_imu;
  json["clock"] = s.wall ? "wall" : "thread";
  json["duration_s"] = outputs.seconds;
  json["frames_dropped"] = source.dropped();
  json["vision"] = SessionJson(session);
  json["interrupted"] = Interrupted();
  if (const Status st = WriteAll(s, run, session, json, errors, has_imu); !st.ok()) {
    return Failed(st);
  }
  if (!frame.ok()) return Failed(frame.status());
  if (const Status st = rerun.status(); !st.ok()) return Failed(st);
  if (!run.initialized_at_s && !Interrupted()) {
    const InitVerdict& verdict = session.window().init_verdict();
    return Failed(
        {StatusCode::kEvaluationFailed, s.folder + ": the window found no first state" +
                                            (verdict.ok() ? "" : ": " + verdict.message)});
  }
  return {};
}

}  // namespace
}  // namespace glissade::app

int main(int argc, char** argv) {
  using namespace glissade::app;
  return Program(kName, kDescription, kFooter).Main<Settings>(argc, argv, AddOptions, Run);
}
