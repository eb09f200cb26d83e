// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/vi_world.h"

#include <cmath>
#include <string>

#include "sim/vi_world_points.h"

namespace glissade::sim {

std::string_view ToString(PointLayout layout) {
  return layout == PointLayout::kPlane ? "plane" : "random";
}

ViCamera ViWorldOptions::DefaultCamera() {
  // Camera x right = -body y, y down = -body z, z forward = body x.
  Matrix3 R_b_c;
  R_b_c << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  ViCamera camera;
  camera.fx = camera.fy = 320.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  camera.width = 640;
  camera.height = 480;
  camera.sigma_px = 2.0;
  camera.T_b_c = Pose(R_b_c, Vector3(0.10, 0.0, 0.02));
  return camera;
}

Status ViWorldOptions::Validate() const {
  const auto wrong = [](const std::string& what) {
    return Status(StatusCode::kInvalidArgument, "world: " + what);
  };
  if (trajectory != TrajectoryKind::kSine && trajectory != TrajectoryKind::kArc &&
      trajectory != TrajectoryKind::kRec) {
    return wrong("trajectory is no TrajectoryKind");
  }
  if (points != PointLayout::kPlane && points != PointLayout::kRandom) {
    return wrong("points is no PointLayout");
  }
  const struct {
    double value;
    const char* name;
  } positive[] = {{length_m, "length_m"},
                  {speed_mps, "speed_mps"},
                  {wall_distance_m, "wall_distance_m"},
                  {floor_distance_m, "floor_distance_m"},
                  {min_depth_m, "min_depth_m"},
                  {max_depth_m, "max_depth_m"},
                  {nearest_visible_m, "nearest_visible_m"},
                  {camera.fx, "camera.fx"},
                  {camera.fy, "camera.fy"},
                  {camera.sigma_px, "camera.sigma_px"},
                  {imu_rate_hz, "imu_rate_hz"}};
  for (const auto& [value, name] : positive) {
    if (Status s = ValidatePositive(value, std::string("world: ") + name); !s.ok()) return s;
  }
  const struct {
    double value;
    const char* name;
  } not_negative[] = {
      {plane_roughness_m, "plane_roughness_m"},   {pixel_noise, "pixel_noise"},
      {accel_bias_sigma, "accel_bias_sigma"},     {gyro_bias_sigma, "gyro_bias_sigma"},
      {start_position_m, "start_position_m"},     {start_rotation_deg, "start_rotation_deg"},
      {start_velocity_mps, "start_velocity_mps"}, {start_point_m, "start_point_m"}};
  for (const auto& [value, name] : not_negative) {
    if (!std::isfinite(value) || value < 0.0) return wrong(std::string(name) + " must be >= 0");
  }
  if (num_keyframes < 2 || num_keyframes > 100000)
    return wrong("num_keyframes must be 2 to 100000");
  if (num_points < 1 || num_points > 1000000) return wrong("num_points must be 1 to 1000000");
  if (min_observations < 1) return wrong("min_observations must be at least 1");
  if (max_depth_m < min_depth_m) return wrong("max_depth_m must not be under min_depth_m");
  if (camera.width < 1 || camera.height < 1) return wrong("the image is empty");
  if (laps < 1 || laps > 10000) return wrong("laps must be 1 to 10000");
  const double duration = laps * length_m / speed_mps;
  if (!(duration < 3600.0 && imu_rate_hz <= 1e5)) return wrong("over an hour, or over 100 kHz");
  if (!(duration * imu_rate_hz >= num_keyframes - 1)) return wrong("fewer IMU samples than frames");
  if (Status s = ValidatePose(camera.T_b_c.data, "world: extrinsic"); !s.ok()) return s;
  if (Status s = ValidateFinite(gravity.data(), 3, "world: gravity"); !s.ok()) return s;
  return imu_noise.Validate();
}

Result<ViWorld> MakeViWorld(const ViWorldOptions& options) {
  if (Status s = options.Validate(); !s.ok()) return s;
  ViWorld world;
  world.options = options;
  world.trajectory =
      Trajectory(options.trajectory, options.length_m, options.speed_mps, options.laps);
  const Trajectory& path = world.trajectory;

  // IMU samples on a regular grid that begins at the first keyframe and covers the last.
  const double period = 1.0 / options.imu_rate_hz;
  const int num_samples = static_cast<int>(std::ceil(path.Duration() / period)) + 1;
  for (int k = 0; k < num_samples; ++k) {
    const double t = k * period;
    const Vector3 force = path.AccelerationAt(t) - options.gravity;
    world.imu_samples.push_back({.stamp_ns = std::llround(1e9 * t),
                                 .gyro = path.AngularRateAt(t),
                                 .accel = path.RotationAt(t).transpose() * force});
  }
  ViProblem& exact = world.exact;
  exact.cameras = {options.camera};
  for (int k = 0; k < options.num_keyframes; ++k) {
    const double t = path.Duration() * k / (options.num_keyframes - 1);
    const std::int64_t stamp = std::llround(1e9 * t);
    exact.stamps_ns.push_back(stamp);
    exact.truth.poses.push_back({path.PoseAt(1e-9 * static_cast<double>(stamp))});
    exact.truth.speed_biases.emplace_back(path.VelocityAt(1e-9 * static_cast<double>(stamp)),
                                          Vector3::Zero(), Vector3::Zero());
  }
  if (Status s = internal::AddPoints(options, path, &exact); !s.ok()) return s;
  exact.start = exact.truth;
  return world;
}

}  // namespace glissade::sim
