// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>

#include "glissade/imu/buffer.h"
#include "glissade/sim/noise_source.h"
#include "glissade/sim/vi_world.h"
#include "sim/vi_measure.h"

namespace glissade::sim {

namespace internal {

ImuReadings DrawImuReadings(const ViWorld& world, std::uint64_t seed) {
  const ViWorldOptions& options = world.options;
  const ImuNoise& noise = options.imu_noise;
  const std::vector<std::int64_t>& stamps = world.exact.stamps_ns;
  NoiseSource random(seed, kImuStream);
  ImuBias bias{random.Normal3(options.accel_bias_sigma), random.Normal3(options.gyro_bias_sigma)};
  ImuReadings readings;
  std::int64_t last = world.imu_samples.front().stamp_ns;
  const double root_rate = std::sqrt(options.imu_rate_hz);
  for (const ImuSample& exact : world.imu_samples) {
    const double h = SecondsBetween(last, exact.stamp_ns);
    const ImuBias before = bias;
    bias.ba += random.Normal3(noise.accel_random_walk * std::sqrt(h));
    bias.bg += random.Normal3(noise.gyro_random_walk * std::sqrt(h));
    for (std::size_t k = readings.biases.size(); k < stamps.size() && stamps[k] <= exact.stamp_ns;
         ++k) {
      const double a = h > 0.0 ? SecondsBetween(last, stamps[k]) / h : 1.0;
      readings.biases.push_back(
          {(1.0 - a) * before.ba + a * bias.ba, (1.0 - a) * before.bg + a * bias.bg});
    }
    last = exact.stamp_ns;
    ImuSample sample = exact;
    sample.accel += bias.ba + random.Normal3(noise.accel_noise_density * root_rate);
    sample.gyro += bias.bg + random.Normal3(noise.gyro_noise_density * root_rate);
    readings.samples.push_back(sample);
  }
  return readings;
}

}  // namespace internal

namespace {

/// IMU terms at the true biases, which go into the truth.
Status DrawImu(const ViWorld& world, std::uint64_t seed, ViProblem* problem) {
  const ViWorldOptions& options = world.options;
  ImuNoise noise = options.imu_noise;
  noise.max_gap_ns = std::int64_t{1} << 62;  // the sensor of this world never stops, however slow
  const internal::ImuReadings readings = internal::DrawImuReadings(world, seed);
  for (std::size_t k = 0; k < readings.biases.size(); ++k) {
    problem->truth.speed_biases[k].ba() = readings.biases[k].ba;
    problem->truth.speed_biases[k].bg() = readings.biases[k].bg;
  }
  ImuBuffer buffer({.max_gap_ns = noise.max_gap_ns});
  for (const ImuSample& sample : readings.samples) {
    if (Status s = buffer.Add(sample); !s.ok()) return s;
  }
  ImuInterval interval;
  for (std::size_t i = 0; i + 1 < problem->stamps_ns.size(); ++i) {
    if (Status s = buffer.Between(problem->stamps_ns[i], problem->stamps_ns[i + 1], &interval);
        !s.ok()) {
      return s;
    }
    const VertexSpeedBias& at = problem->truth.speed_biases[i];
    const auto preintegration = Preintegrate(interval.samples, {at.ba(), at.bg()}, noise);
    if (!preintegration.ok()) return preintegration.status();
    auto factor = MakeImuFactor(*preintegration);
    if (!factor.ok()) return factor.status();
    factor->edge.gravity = options.gravity;
    problem->imu.push_back(*factor);
  }
  return {};
}

void DrawStart(const ViWorldOptions& options, std::uint64_t seed, ViProblem* problem) {
  NoiseSource random(seed, internal::kStartStream);
  problem->start = problem->truth;
  const double angle = std::numbers::pi / 180.0 * options.start_rotation_deg;
  for (std::size_t k = 0; k < problem->start.poses.size(); ++k) {
    const Vector3 dp = options.start_position_m * random.Direction();
    const Vector3 dtheta = angle * random.Direction();
    const Vector3 dv = random.Uniform3(options.start_velocity_mps);
    if (k == 0 && !options.perturb_first) continue;
    const double delta[6] = {dp[0], dp[1], dp[2], dtheta[0], dtheta[1], dtheta[2]};
    problem->start.poses[k].Plus(delta);
    problem->start.speed_biases[k].v() += dv;
  }
  for (VertexPointXYZ& point : problem->start.points)
    point.p() += random.Uniform3(options.start_point_m);
}

}  // namespace

Result<ViProblem> Measure(const ViWorld& world, std::uint64_t seed) {
  ViProblem problem = world.exact;
  NoiseSource random(seed, internal::kPixelStream);
  for (ViObservation& o : problem.observations) {
    o.u += random.Normal(world.options.pixel_noise);
    o.v += random.Normal(world.options.pixel_noise);
  }
  if (world.imu_samples.empty()) {
    return Status(StatusCode::kInvalidArgument, "a world that MakeViWorld did not make");
  }
  if (Status s = DrawImu(world, seed, &problem); !s.ok()) return s;
  DrawStart(world.options, seed, &problem);
  return problem;
}

}  // namespace glissade::sim
