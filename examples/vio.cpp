// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A visual-inertial odometry: what comes from the sensors goes into a SlidingWindow, its newest
// state comes out. The sensors are a recording (VIOTRACKS) or, without an argument, a simulated
// flight. Prints the trajectory as TUM has it, and the error where there is a ground truth.
//
//     vio [DIRECTORY] > trajectory.tum
#include <glissade/eval/absolute_error.h>
#include <glissade/eval/alignment.h>
#include <glissade/io/replay.h>
#include <glissade/io/viotracks.h>
#include <glissade/sim/recording.h>
#include <glissade/window/sliding_window.h>

#include <cstdio>
#include <memory>

using namespace glissade;

namespace {

/// Ends with what was refused, and why.
int Refused(const Status& status) {
  std::fprintf(stderr, "vio: %s\n", status.message().c_str());
  return 1;
}

void PrintPose(const eval::StampedPose& pose) {
  const double* x = pose.T_w_b.data;  // px py pz qx qy qz qw
  std::printf("%lld.%09lld %.6f %.6f %.6f %.9f %.9f %.9f %.9f\n",
              static_cast<long long>(pose.stamp_ns / 1'000'000'000),
              static_cast<long long>(pose.stamp_ns % 1'000'000'000), x[0], x[1], x[2], x[3], x[4],
              x[5], x[6]);
}

/// RMS of the positions after alignment by what the sensors cannot observe: position and yaw, and
/// without an IMU the whole rotation.
Result<double> TrajectoryError(const eval::Trajectory& estimate, const Viotracks& recording) {
  eval::Trajectory reference;
  for (const GroundTruthState& state : recording.ground_truth)
    reference.push_back({state.stamp_ns, state.T_w_b});
  auto matched = eval::Associate(estimate, reference);
  if (!matched.ok()) return matched.status();
  const auto kind = recording.imu_noise ? eval::AlignmentKind::kYaw : eval::AlignmentKind::kSe3;
  const auto alignment = eval::Align(*matched, {.kind = kind});
  if (!alignment.ok()) return alignment.status();
  eval::ApplyAlignment(*alignment, matched->estimate);
  const auto errors = eval::ComputeAbsoluteErrors(*matched);
  if (!errors.ok()) return errors.status();
  return errors->translation_m.rmse;
}

}  // namespace

int main(int argc, char** argv) {
  const auto recording =
      argc > 1 ? ReadViotracks(argv[1]) : sim::MakeRecording(sim::RecordingOptions());
  if (!recording.ok()) return Refused(recording.status());

  // 1. What the window has to know beforehand.
  SlidingWindowOptions options;
  options.cameras = WindowCameras(*recording);
  options.imu_noise = recording->imu_noise;
  options.gravity = recording->gravity.norm();
  options.policy = std::make_shared<OkvisPolicy>(3, 7);  // newest frames, keyframes
  if (const Status s = options.Validate(); !s.ok()) return Refused(s);
  SlidingWindow window(options);

  // 2. What comes from the sensors goes in, in the order of time; the newest state comes out.
  eval::Trajectory trajectory;
  ViotracksReplay sensors(*recording);
  while (sensors.Next()) {
    // Samples that make no sense are left out, and counted: window.total_events().
    if (recording->imu_noise) static_cast<void>(window.AddImu(sensors.imu()));
    Status status = window.AddFrame(sensors.stamp_ns(), sensors.observations());
    if (status.ok()) status = window.Optimize({.max_iterations = 4});
    if (!status.ok()) {
      // The window goes on with the next frame.
      std::fprintf(stderr, "vio: frame %zu: %s\n", sensors.frame(), status.message().c_str());
      continue;
    }
    if (window.phase() != WindowPhase::kRunning) continue;  // no first state yet
    const WindowState& state = window.newest();
    trajectory.push_back({state.stamp_ns, state.T_w_b});
    PrintPose(trajectory.back());
  }
  if (trajectory.empty()) {
    std::fprintf(stderr, "vio: no first state was found\n");
    return 1;
  }

  // 3. How far off?
  if (recording->ground_truth.empty()) return 0;
  const auto error = TrajectoryError(trajectory, *recording);
  if (!error.ok()) return Refused(error.status());
  std::printf("# %zu of %zu frames, %lld keyframes; RMS position error %.3f m\n", trajectory.size(),
              recording->frames.size(),
              static_cast<long long>(window.total_events()[WindowEvent::kKeyframe]), *error);
  return argc > 1 || *error < 0.15 ? 0 : 1;  // the simulated flight: 14 m
}
