// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/windows.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "glissade/sim/noise_source.h"
#include "sim/vi_measure.h"

namespace glissade::sim {

namespace {

Status Refused(const char* what) {
  return {StatusCode::kInvalidArgument, std::string("window: ") + what};
}

/// Binary fractions have few decimal digits.
double Rounded(double x) {
  return std::round(x * 256.0) / 256.0;
}

/// An integer from low to high.
int Draw(NoiseSource* random, int low, int high) {
  return low + std::min(high - low, static_cast<int>(random->Uniform(0.0, high - low + 1.0)));
}

void AddLandmarks(const WindowMakerOptions& options, const ViProblem& data, std::uint64_t seed,
                  ViowinWindow* window) {
  NoiseSource random(seed, internal::kLandmarkStream);
  std::vector<std::vector<const ViObservation*>> seen(data.truth.points.size());
  for (const ViObservation& o : data.observations)
    seen[static_cast<std::size_t>(o.point)].push_back(&o);
  const auto wanted =
      static_cast<std::size_t>(options.landmarks_per_keyframe * options.num_keyframes);
  int hosted_by_first = 0;
  for (std::size_t p = 0; p < seen.size() && window->landmarks.size() < wanted; ++p) {
    const auto& list = seen[p];  // in the order of the keyframes
    const int length = Draw(&random, options.min_track, options.max_track);
    const int size = static_cast<int>(list.size());
    int first = Draw(&random, 0, std::max(0, size - options.min_track));
    const bool must_be_first = hosted_by_first < options.hosted_by_first;
    if (must_be_first && list[0]->keyframe != 0) continue;
    if (must_be_first) first = 0;
    const ViObservation& host = *list[static_cast<std::size_t>(first)];
    ViowinLandmark landmark;
    landmark.host = host.keyframe;
    landmark.u_host = Rounded(host.u);
    landmark.v_host = Rounded(host.v);
    const Pose T_w_c =
        data.truth.poses[static_cast<std::size_t>(host.keyframe)].pose * data.cameras[0].T_b_c;
    landmark.rho_true = 1.0 / (T_w_c.Inverse() * Vector3(data.truth.points[p].p()))[2];
    landmark.rho = landmark.rho_true * std::exp(random.Normal(options.start_log_depth));
    for (int k = first + 1; k < std::min(first + length, size); ++k) {
      const ViObservation& o = *list[static_cast<std::size_t>(k)];
      if (o.keyframe != host.keyframe + (k - first)) break;  // out of sight in between
      landmark.observations.push_back({o.keyframe, Rounded(o.u), Rounded(o.v)});
    }
    if (static_cast<int>(landmark.observations.size()) + 1 < options.min_track) continue;
    if (landmark.host == 0) ++hosted_by_first;
    window->landmarks.push_back(std::move(landmark));
  }
}

void AddStates(const WindowMakerOptions& options, const ViProblem& data, std::uint64_t seed,
               ViowinWindow* window) {
  NoiseSource random(seed, internal::kLandmarkStream + 1);
  const Vector3 ba = random.Normal3(options.start_accel_bias);
  const Vector3 bg = random.Normal3(options.start_gyro_bias);
  for (std::size_t k = 0; k < data.stamps_ns.size(); ++k) {
    const double stamp = 1e-9 * static_cast<double>(data.stamps_ns[k]);
    window->ground_truth.push_back({stamp, data.truth.poses[k].pose, data.truth.speed_biases[k]});
    window->keyframes.push_back({stamp, data.start.poses[k].pose, data.start.speed_biases[k]});
    window->keyframes.back().speed_bias.ba() += ba;
    window->keyframes.back().speed_bias.bg() += bg;
  }
}

void AddPriors(ViowinWindow* window) {
  const auto last = static_cast<std::int32_t>(window->ground_truth.size()) - 1;
  constexpr double kTight = 500.0, kTightRotation = 2000.0, kLoose = 20.0;  // 1/m, 1/rad
  window->pose_priors.push_back(
      {0,
       3,
       window->ground_truth.front().T_w_b,
       {kTight, kTight, kTight, kTightRotation, kTightRotation, kTightRotation}});
  window->pose_priors.push_back({last,
                                 1,
                                 window->ground_truth.back().T_w_b,
                                 {kLoose, kLoose, kLoose, kLoose, kLoose, kLoose}});
  ViowinSpeedBiasPrior prior;
  prior.prior = window->keyframes.front().speed_bias;
  prior.sqrt_information = {20, 20, 20, 20, 20, 20, 200, 200, 200};
  window->speed_bias_priors.push_back(prior);
}

}  // namespace

ViWorldOptions WindowMakerOptions::DefaultWorld() {
  ViWorldOptions world;
  world.points = PointLayout::kRandom;
  world.speed_mps = 1.5;
  world.min_depth_m = 2.5;
  world.max_depth_m = 15.0;
  world.camera.fx = world.camera.fy = 460.0;
  world.camera.cx = 376.0;
  world.camera.cy = 240.0;
  world.camera.width = 752;
  world.camera.height = 480;
  world.camera.sigma_px = 1.0;
  world.pixel_noise = 1.0;
  world.imu_noise = ImuNoise();
  world.accel_bias_sigma = 0.05;
  world.gyro_bias_sigma = 0.005;
  world.start_position_m = 0.04;
  world.start_rotation_deg = 0.7;
  world.perturb_first = false;
  return world;
}

Status WindowMakerOptions::Validate() const {
  if (num_keyframes < 2 || num_keyframes > 1000) return Refused("num_keyframes must be 2 to 1000");
  if (!(interval_s > 0.0 && interval_s <= 10.0)) return Refused("interval_s must be 0 to 10");
  if (landmarks_per_keyframe < 1 || landmarks_per_keyframe > 10000) {
    return Refused("landmarks_per_keyframe must be 1 to 10000");
  }
  if (min_track < 2 || max_track < min_track || min_track > num_keyframes) {
    return Refused("min_track must be 2 to max_track and at most num_keyframes");
  }
  if (hosted_by_first < 0 || hosted_by_first > landmarks_per_keyframe * num_keyframes) {
    return Refused("hosted_by_first must be 0 to the number of landmarks");
  }
  for (const double x : {start_log_depth, start_accel_bias, start_gyro_bias}) {
    if (!(x >= 0.0 && std::isfinite(x))) return Refused("sigmas of the start must be >= 0");
  }
  return world.Validate();
}

Result<ViowinWindow> MakeWindow(const WindowMakerOptions& options, std::uint64_t seed) {
  if (Status s = options.Validate(); !s.ok()) return s;
  ViWorldOptions world_options = options.world;
  world_options.num_keyframes = options.num_keyframes;
  world_options.length_m =
      world_options.speed_mps * options.interval_s * (options.num_keyframes - 1);
  // Some points do not become landmarks: their tracks are too short.
  world_options.num_points = 3 * options.landmarks_per_keyframe * options.num_keyframes;
  world_options.min_observations = options.min_track;
  world_options.seed = seed;
  const auto world = MakeViWorld(world_options);
  if (!world.ok()) return world.status();
  const auto data = Measure(*world, seed);
  if (!data.ok()) return data.status();

  ViowinWindow window;
  window.id = static_cast<std::int64_t>(seed);
  const ViCamera& c = data->cameras[0];
  window.camera = {c.fx, c.fy, c.cx, c.cy, c.width, c.height, c.sigma_px};
  window.T_b_c = c.T_b_c;
  window.gravity = world_options.gravity;
  AddStates(options, *data, seed, &window);
  AddLandmarks(options, *data, seed, &window);
  if (window.landmarks.size() <
      static_cast<std::size_t>(options.landmarks_per_keyframe * options.num_keyframes)) {
    return Refused("too few points are seen long enough");
  }
  AddPriors(&window);
  for (std::size_t k = 0; k < data->imu.size(); ++k) {
    window.imu.push_back({.i = static_cast<std::int32_t>(k),
                          .j = static_cast<std::int32_t>(k + 1),
                          .imu = data->imu[k].edge.imu,
                          .sqrt_information = *data->imu[k].options.sqrt_information});
  }
  return window;
}

}  // namespace glissade::sim
