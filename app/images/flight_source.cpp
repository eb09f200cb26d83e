// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/flight_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "glissade/io/viotracks.h"
#include "glissade/sim/recording.h"
#include "glissade/vision/image_recording.h"

namespace glissade::app {

namespace {

vision::Camera CameraOf(const ViotracksCamera& c) {
  vision::Camera camera;
  camera.lens = CameraPinhole{c.fx, c.fy, c.cx, c.cy};
  camera.width = c.width;
  camera.height = c.height;
  camera.T_b_c = c.T_b_c;
  return camera;
}

FlightSource Of(Viotracks recording) {
  FlightSource source;
  source.origin = std::move(recording.origin);
  source.is_rectified = true;
  for (const ViotracksCamera& camera : recording.cameras)
    source.cameras.push_back(CameraOf(camera));
  source.imu_noise = recording.imu_noise;
  source.imu_rate_hz = recording.imu_rate_hz;
  source.imu = std::move(recording.imu);
  source.ground_truth = std::move(recording.ground_truth);
  source.gravity = recording.gravity;
  return source;
}

Result<FlightSource> ReadSource(const std::string& folder) {
  std::error_code error;
  if (std::filesystem::exists(std::filesystem::path(folder) / "calibration.json", error)) {
    auto recording = ReadViotracks(folder);
    if (!recording.ok()) return recording.status();
    return Of(std::move(recording).value());
  }
  auto recording = vision::ReadImageRecording(folder);
  if (!recording.ok()) return recording.status();
  FlightSource source;
  source.origin = recording->layout + " recording";
  source.cameras = std::move(recording->cameras);
  source.imu_noise = recording->imu_noise;
  source.imu_rate_hz = recording->imu_rate_hz;
  source.imu = std::move(recording->imu);
  source.ground_truth = std::move(recording->ground_truth);
  // KITTI's world is the first camera: y down.
  if (recording->layout.starts_with("KITTI")) source.gravity = Vector3(0.0, 9.81, 0.0);
  return source;
}

}  // namespace

Result<FlightSource> ReadFlight(const std::string& folder) {
  auto source = ReadSource(folder);
  if (!source.ok()) return source;
  const auto refused = [&](const char* why) {
    return Status(StatusCode::kInvalidArgument, folder + ": " + why);
  };
  if (source->ground_truth.size() < 2) return refused("has no ground truth to fly along");
  if (source->cameras.empty() || source->cameras.size() > 2) {
    return refused("must have one or two cameras");
  }
  const auto not_later = [](const ImuSample& a, const ImuSample& b) {
    return b.stamp_ns <= a.stamp_ns;
  };
  const auto& imu = source->imu;
  if (std::adjacent_find(imu.begin(), imu.end(), not_later) != imu.end()) {
    return refused("stamps of the IMU do not increase");
  }
  return source;
}

Result<FlightSource> SimulateFlight(const SplineOptions& options) {
  sim::RecordingOptions recording;
  recording.seed = recording.world.seed = options.seed;
  recording.world.trajectory = options.kind;
  recording.world.length_m = options.lap_m;
  recording.world.speed_mps = options.speed_mps;
  const double laps = std::ceil(options.seconds * options.speed_mps / options.lap_m - 1e-9);
  recording.world.laps = static_cast<int>(std::clamp(laps, 1.0, 1e5));
  // For its truth: the flight between two states is a cubic to 1e-7 m. Of its points we need none.
  recording.frame_rate_hz = 100.0;
  recording.world.num_points = 1;
  auto made = sim::MakeRecording(recording);
  if (!made.ok()) return made.status();
  return Of(std::move(made).value());
}

}  // namespace glissade::app
