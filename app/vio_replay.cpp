// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Hands a recorded run to a sliding window as it would have come from the sensors, and judges what
// the window said.
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/interrupt.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/version.h"
#include "glissade/io/trajectory.h"
#include "glissade/io/viotracks.h"
#include "replay/batch.h"
#include "replay/causal_run.h"
#include "replay/consistency.h"
#include "replay/judge.h"
#include "replay/report.h"
#include "studies/parallel_trials.h"

namespace glissade::app {
namespace {

constexpr const char* kName = "vio_replay";

constexpr const char* kDescription =
    R"(Hands a recording (VIOTRACKS) to a sliding-window estimator, sample by sample and frame by frame,
and says how far its estimates are from the truth, how long they took, and what happened.)";

constexpr const char* kFooter =
    R"(The estimate of a frame is what the window said right after it, never what it learned later.

ATE is the RMS of positions after alignment: by yaw and translation with an IMU, by SE(3) without.
RPE is over 1 s (RMS) and in percent of the distance travelled (mean over pieces of 100 m; of a way
shorter than 150 m, 10 m; than 15 m, 1 m). Yaw drift is that of the last pose where the first has
no error. With --time-offset a ground truth that has the frames' own stamps is taken to be on
their clock, another one on the IMU's. Without ground truth there is everything but errors.

Stages: add (samples, prediction, tracks, triangulation), solve, reject (outliers, IMU terms
integrated anew), slide (the policy, marginalization); with --consistency or --states also the
covariance of the newest state, which is not part of a frame. Times are those of the thread's own
clock, which others on the machine do not disturb much; --wall has those of the clock on the wall.
Solve and reject are told apart in frames only in which the two clocks agree.

Kinds of --fault: imu-gap, no-features, all-outliers, camera-lost (the second one), nan-pixels
(every second feature), imu-saturated (clipped at half of the largest rate and motion, and marked),
frame-duplicate, frame-out-of-order (in pairs), imu-out-of-order (in pairs), imu-duplicate.

Examples:
  vio_replay data/flight                              stereo and IMU, S = 3, M = 7
  vio_replay data/flight --mono --policy vins --output flight.tum
  vio_replay data/flight --fault imu-gap@4..4.3 --fault no-features@6..7
  vio_replay data/flight --batch --json flight.json   and the bound
  vio_replay data/flight --states flight.csv
  scripts/plot_trajectory.py flight.csv data/flight flight.png

After Ctrl-C the figures are those of the frames until then.

Exit code: 0; 130 after Ctrl-C; 2 where the recording or an option makes no sense; 1 where the
window found no first state.)";

struct Settings {
  std::string folder;
  ReplaySettings replay;
  std::string first_estimates = "full";
  double rpe_length_m = 0.0;
  bool batch = false;
  bool consistency = false;
  std::string out, states, json;
};

void AddOptions(Program& program, Settings& s) {
  CLI::App& cli = program.cli();
  cli.add_option("DIR", s.folder, "Folder of a recording (VIOTRACKS)")->required();
  AddChoice(cli, "--policy", &s.replay.policy, {"okvis", "vins", "basalt", "lag"},
            "What leaves the window (default okvis); vins: two-way, S + M frames");
  AddInteger(cli, "--frames", &s.replay.frames, 1, 1000,
             "Newest frames of a window, S, with speed and biases (default 3)");
  AddInteger(cli, "--keyframes", &s.replay.keyframes, 1, 1000,
             "Keyframes of a window, M, besides these (default 7)");
  AddNumber(cli, "--lag", &s.replay.lag_s, 0.01, 1000.0, "Of --policy lag (s; default 1)");
  cli.add_flag("--mono", s.replay.mono, "The first camera only");
  cli.add_flag("--no-imu", s.replay.no_imu, "Two cameras without the IMU");
  AddChoice(cli, "--first-estimates", &s.first_estimates, {"off", "prior", "full"},
            "What stays linearized where it first was (default full)");
  AddNumber(cli, "--time-offset", &s.replay.time_offset_s, -10.0, 10.0,
            "Added to the stamps of frames (s; default 0)");
  AddInteger(cli, "--iterations", &s.replay.budget.max_iterations, 1, 1000,
             "At most N steps of a frame (default 4)");
  AddFaults(cli, ParseFault, &s.replay.faults);
  AddNumber(cli, "--rpe-length", &s.rpe_length_m, 0.01, 1e6,
            "Of the pieces for RPE in percent (m; default: by the way's length)");
  cli.add_flag("--batch", s.batch,
               "Solve the same data as one big problem too: the bound for a window");
  cli.add_flag("--consistency", s.consistency,
               "Hold the covariance of each newest pose against its error (NEES)");
  cli.add_flag("--wall", s.replay.wall_clock, "Times of the clock on the wall");
  program.AddOutputFile("--output,--out", &s.out, "Write the trajectory (TUM) to FILE");
  program.AddOutput("--states", &s.states, "Write states, sigmas, window sizes (CSV) to FILE");
  program.AddJson(&s.json);
}

/// Absent where the recording has no ground truth.
std::optional<TrajectoryErrors> ErrorsOf(eval::Trajectory estimate, const Viotracks& recording,
                                         const Settings& settings) {
  if (recording.ground_truth.empty()) return {};
  if (OnFramesClock(recording)) {
    for (eval::StampedPose& pose : estimate)
      pose.stamp_ns -= std::llround(1e9 * settings.replay.time_offset_s);
  }
  const bool has_imu = recording.imu_noise.has_value() && !settings.replay.no_imu;
  return Judge(estimate, ReferenceOf(recording), {has_imu, settings.rpe_length_m});
}

Outcome Run(Settings& settings) {
  const auto recording = ReadViotracks(settings.folder);
  if (!recording.ok()) return BadInput(recording.status());
  ReplaySettings& replay = settings.replay;
  replay.first_estimates = ParseFirstEstimates(settings.first_estimates);
  replay.covariance = settings.consistency || !settings.states.empty();
  replay.observations = settings.batch;
  const auto window = WindowOptions(*recording, replay);
  if (!window.ok()) return BadInput(settings.folder + ": " + window.status().message());

  Result<CausalRun> run = [&] {
    ProgressBar progress(static_cast<int>(recording->frames.size()));
    progress.SetLabel(settings.folder);
    return RunCausal(*recording, replay, [&] { progress.Advance(); });
  }();
  if (!run.ok()) return Failed(run.status());
  const eval::Trajectory trajectory = TrajectoryOf(*run);
  const auto errors = ErrorsOf(trajectory, *recording, settings);
  PrintRun(*run, errors);
  std::fflush(TextStream());

  nlohmann::ordered_json json = JsonHeader(kName, settings.folder);
  AddRun(*run, errors, &json);
  if (settings.consistency) {
    const bool on_frames_clock = OnFramesClock(*recording);
    const auto consistency =
        ConsistencyOf(*run, *recording, on_frames_clock ? replay.time_offset_s : 0.0,
                      window->imu_noise.has_value());
    PrintConsistency(consistency);
    json["consistency"] = ToJson(consistency);
  }
  json["policy"] = replay.policy;
  json["cameras"] = window->cameras.size();
  json["imu"] = window->imu_noise.has_value();
  json["clock"] = replay.wall_clock ? "wall" : "thread";
  Status failed;
  if (settings.batch && run->initialized_at_s && !Interrupted()) {
    const auto batch = SolveBatch(*recording, replay, *run);
    if (batch.ok()) {
      const auto batch_errors = ErrorsOf(batch->trajectory, *recording, settings);
      PrintBatch(*batch, batch_errors);
      json["batch"] = ToJson(*batch, batch_errors);
    } else {
      failed = batch.status();
    }
  }
  json["interrupted"] = Interrupted();
  if (!settings.out.empty()) {
    if (Status s = WriteTumTrajectory(trajectory, settings.out); !s.ok()) return Failed(s);
  }
  if (!settings.states.empty()) {
    if (Status s = WriteFile(settings.states, StatesCsv(*run)); !s.ok()) return Failed(s);
  }
  if (!settings.json.empty()) {
    if (Status s = WriteJson(settings.json, json, 2); !s.ok()) return Failed(s);
  }
  if (!failed.ok()) return Failed(failed);
  if (!run->initialized_at_s && !Interrupted()) {
    return Failed({StatusCode::kEvaluationFailed,
                   settings.folder + ": the window found no first state" +
                       (run->first_refusal.empty() ? "" : ": " + run->first_refusal)});
  }
  return {};
}

}  // namespace
}  // namespace glissade::app

int main(int argc, char** argv) {
  using namespace glissade::app;
  return Program(kName, kDescription, kFooter).Main<Settings>(argc, argv, AddOptions, Run);
}
