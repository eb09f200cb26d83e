// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/recording.h"

#include <cmath>
#include <string>
#include <vector>

#include "glissade/sim/noise_source.h"
#include "sim/vi_measure.h"

namespace glissade::sim {

namespace {

Status Refused(const char* what) {
  return {StatusCode::kInvalidArgument, std::string("recording: ") + what};
}

/// To a multiple of 1 / steps: a number with few digits.
double Rounded(double x, double steps) {
  return std::round(x * steps) / steps;
}

Vector3 Rounded(const Vector3& x, double steps) {
  return {Rounded(x[0], steps), Rounded(x[1], steps), Rounded(x[2], steps)};
}

ViotracksCamera Recorded(const ViCamera& c) {
  ViotracksCamera camera;
  camera.fx = c.fx;
  camera.fy = c.fy;
  camera.cx = c.cx;
  camera.cy = c.cy;
  camera.width = c.width;
  camera.height = c.height;
  camera.sigma_px = c.sigma_px;
  camera.T_b_c = c.T_b_c;
  return camera;
}

/// Tracks of all points: from the frame that first sees one to the last, or to where it is lost.
void DrawTracks(const RecordingOptions& options, const ViWorld& world, Viotracks* recording) {
  NoiseSource pixels(options.seed, internal::kPixelStream);
  NoiseSource luck(options.seed, internal::kTrackStream);
  const double sigma = options.world.pixel_noise;
  struct Track {
    std::int32_t id = -1, last_frame = -2;
  };
  std::vector<Track> tracks(world.exact.truth.points.size());
  std::int32_t next_id = 0;
  const auto record = [&](const ViObservation& exact, std::int32_t camera, double u, double v) {
    const ViotracksCamera& c = recording->cameras[static_cast<std::size_t>(camera)];
    if (!(u >= 0.0 && u < c.width && v >= 0.0 && v < c.height)) return;
    u += pixels.Normal(sigma);
    v += pixels.Normal(sigma);
    if (luck.Uniform(0.0, 1.0) < options.outliers) {
      u = luck.Uniform(0.0, c.width);
      v = luck.Uniform(0.0, c.height);
    }
    recording->tracks.push_back({.frame = exact.keyframe,
                                 .track = tracks[static_cast<std::size_t>(exact.point)].id,
                                 .camera = camera,
                                 .u = Rounded(u, 1e2),
                                 .v = Rounded(v, 1e2)});
  };
  for (const ViObservation& o : world.exact.observations) {  // frame by frame
    const auto point = static_cast<std::size_t>(o.point);
    Track& track = tracks[point];
    const bool lost = luck.Uniform(0.0, 1.0) < options.loss_per_frame;
    if (lost || track.last_frame + 1 != o.keyframe) track.id = next_id++;
    track.last_frame = o.keyframe;
    record(o, 0, o.u, o.v);
    // A rectified pair: the same row, shifted by the disparity.
    const auto frame = static_cast<std::size_t>(o.keyframe);
    const Pose T_w_c = world.exact.truth.poses[frame].pose * options.world.camera.T_b_c;
    const double depth = (T_w_c.Inverse() * Vector3(world.exact.truth.points[point].p()))[2];
    record(o, 1, o.u - options.world.camera.fx * options.baseline_m / depth, o.v);
  }
}

}  // namespace

ViWorldOptions RecordingOptions::DefaultWorld() {
  ViWorldOptions world;
  world.trajectory = TrajectoryKind::kRec;
  world.length_m = 15.0;
  world.speed_mps = 1.25;
  world.num_points = 80;
  world.pixel_noise = 1.0;
  world.camera.sigma_px = 1.0;
  world.imu_noise = ImuNoise();
  return world;
}

Status RecordingOptions::Validate() const {
  if (!(frame_rate_hz > 0.0 && frame_rate_hz <= 1e3)) return Refused("frame_rate_hz: 0 to 1000");
  if (!(baseline_m > 0.0 && std::isfinite(baseline_m))) return Refused("baseline_m must be > 0");
  if (!(loss_per_frame >= 0.0 && loss_per_frame <= 1.0)) return Refused("loss_per_frame: 0 to 1");
  if (!(outliers >= 0.0 && outliers <= 1.0)) return Refused("outliers must be 0 to 1");
  return world.Validate();
}

Result<Viotracks> MakeRecording(const RecordingOptions& options) {
  if (Status s = options.Validate(); !s.ok()) return s;
  ViWorldOptions world_options = options.world;
  const double duration = world_options.laps * world_options.length_m / world_options.speed_mps;
  world_options.num_keyframes =
      1 + static_cast<int>(std::lround(std::min(duration * options.frame_rate_hz, 1e6)));
  const auto made = MakeViWorld(world_options);
  if (!made.ok()) return made.status();
  const ViWorld& world = *made;

  Viotracks recording;
  recording.origin = "simulated by glissade (sim/recording.h), seed " +
                     std::to_string(options.world.seed) + " of the world and " +
                     std::to_string(options.seed) + " of the measurements";
  recording.gravity = world_options.gravity;
  ViCamera right = world_options.camera;
  right.T_b_c.p() = world_options.camera.T_b_c * Vector3(options.baseline_m, 0.0, 0.0);
  recording.cameras = {Recorded(world_options.camera), Recorded(right)};
  recording.imu_noise = world_options.imu_noise;
  recording.imu_rate_hz = world_options.imu_rate_hz;
  internal::ImuReadings readings = internal::DrawImuReadings(world, options.seed);
  for (ImuSample& sample : readings.samples) {
    sample.gyro = Rounded(sample.gyro, 1e6);
    sample.accel = Rounded(sample.accel, 1e5);
  }
  recording.imu = std::move(readings.samples);
  for (std::size_t k = 0; k < world.exact.stamps_ns.size(); ++k) {
    const std::int64_t stamp = world.exact.stamps_ns[k];
    recording.frames.push_back({.id = static_cast<std::int32_t>(k), .stamp_ns = stamp});
    const VertexSpeedBias& exact = world.exact.truth.speed_biases[k];
    recording.ground_truth.push_back(
        {.stamp_ns = stamp,
         .T_w_b = world.exact.truth.poses[k].pose,
         .speed_bias = VertexSpeedBias(exact.v(), readings.biases[k].ba, readings.biases[k].bg)});
  }
  DrawTracks(options, world, &recording);
  return recording;
}

}  // namespace glissade::sim
