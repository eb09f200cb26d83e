// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "glissade/io/viotracks.h"
#include "glissade/lie/so3.h"
#include "glissade/sim/noise_source.h"
#include "glissade/window/initialize_in_motion.h"

namespace glissade::test {

/// A recording as initialisation wants it.
class MotionInput {
 public:
  MotionInput(const Viotracks& recording, bool mono) : recording_(recording) {
    for (const ViotracksCamera& c : recording.cameras) {
      WindowCamera camera;
      camera.fx = c.fx;
      camera.fy = c.fy;
      camera.cx = c.cx;
      camera.cy = c.cy;
      camera.sigma_px = c.sigma_px;
      camera.T_b_c = c.T_b_c;
      cameras.push_back(camera);
      if (mono) break;
    }
    seen.resize(recording.frames.size());
    for (const ViotracksObservation& o : recording.tracks) {
      if (static_cast<std::size_t>(o.camera) >= cameras.size()) continue;
      seen[static_cast<std::size_t>(o.frame)].push_back({o.track, o.camera, o.u, o.v});
    }
  }

  /// Frames [begin, begin + count), and no IMU sample after the one that follows the last frame.
  [[nodiscard]] InitializationInput Window(std::size_t begin, std::size_t count) {
    frames.clear();
    for (std::size_t k = begin; k < std::min(begin + count, seen.size()); ++k)
      frames.push_back({recording_.frames[k].stamp_ns, seen[k]});
    const auto earlier = [](const ImuSample& s, std::int64_t t) { return s.stamp_ns < t; };
    const auto& imu = recording_.imu;
    auto first = std::lower_bound(imu.begin(), imu.end(), frames.front().stamp_ns, earlier);
    auto last = std::lower_bound(first, imu.end(), frames.back().stamp_ns, earlier);
    if (first != imu.begin()) --first;
    if (last != imu.end()) ++last;
    samples.assign(first, last);
    InitializationInput input;
    input.cameras = cameras;
    input.frames = frames;
    input.imu = samples;
    if (recording_.imu_noise) input.noise = *recording_.imu_noise;
    input.gravity = recording_.gravity.norm();
    return input;
  }

  std::vector<WindowCamera> cameras;
  std::vector<std::vector<FrameObservation>> seen;  ///< by frame
  std::vector<FrameObservations> frames;            ///< of the last Window()
  std::vector<ImuSample> samples;                   ///< of the last Window()

 private:
  const Viotracks& recording_;
};

/// What is wrong with an initialised window: states against ground truth, in the window's gauge.
struct MotionErrors {
  double log_scale = 0.0;
  double gravity = 0.0;   ///< rad
  double velocity = 0.0;  ///< m/s
  double nees = 0.0;      ///< of the newest state, 15 numbers

  MotionErrors(const MotionState& state, const std::vector<GroundTruthState>& truth) {
    const auto at = [&](std::int64_t stamp) {
      return *std::lower_bound(
          truth.begin(), truth.end() - 1, stamp,
          [](const GroundTruthState& x, std::int64_t t) { return x.stamp_ns < t; });
    };
    // Yaw of the first frame: no rotation about z is left between the two.
    const Pose first = at(state.frames.front().stamp_ns).T_w_b;
    const Eigen::Matrix3d R_first = state.frames.front().pose.pose.R();
    Eigen::Matrix3d Rz = Eigen::Matrix3d::Identity();
    for (int k = 0; k < 20; ++k) {
      const Vector3 off = so3::Log(Matrix3(R_first * (Rz * first.R()).transpose()));
      Rz = so3::Exp(Vector3(0.0, 0.0, off[2])) * Rz;
    }
    const auto in_gauge = [&](const Pose& T) {
      return Pose(Matrix3(Rz * T.R()), Vector3(Rz * (T.p() - first.p())));
    };
    Eigen::Vector3d mean = Eigen::Vector3d::Zero(), mean_truth = mean;
    const double n = static_cast<double>(state.frames.size());
    for (const InitializedFrame& f : state.frames) {
      mean += f.pose.pose.p() / n;
      mean_truth += in_gauge(at(f.stamp_ns).T_w_b).p() / n;
    }
    double squares = 0.0, squares_truth = 0.0;
    for (const InitializedFrame& f : state.frames) {
      squares += (f.pose.pose.p() - mean).squaredNorm();
      squares_truth += (in_gauge(at(f.stamp_ns).T_w_b).p() - mean_truth).squaredNorm();
    }
    log_scale = 0.5 * std::log(squares / squares_truth);

    const InitializedFrame& newest = state.frames.back();
    const GroundTruthState end = at(newest.stamp_ns);
    const Pose T = in_gauge(end.T_w_b);
    const Eigen::Vector3d up = newest.pose.pose.R().transpose() * Vector3::UnitZ();
    const Eigen::Vector3d up_true = T.R().transpose() * Vector3::UnitZ();
    gravity = up_true.cross(up).norm();
    Eigen::Matrix<double, 15, 1> e;
    e.head<3>() = T.p() - newest.pose.pose.p();
    e.segment<3>(3) = so3::Log(Matrix3(newest.pose.pose.R().transpose() * T.R()));
    if (end.speed_bias) {
      e.segment<3>(6) = Rz * end.speed_bias->v() - newest.speed_bias.v();
      e.segment<3>(9) = end.speed_bias->ba() - newest.speed_bias.ba();
      e.segment<3>(12) = end.speed_bias->bg() - newest.speed_bias.bg();
      velocity = e.segment<3>(6).norm();
    }
    const Eigen::Matrix<double, 15, 15> C = state.covariance;
    const Eigen::Matrix<double, 15, 1> d = C.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::Matrix<double, 15, 15> scaled = d.asDiagonal() * C * d.asDiagonal();
    nees = d.cwiseProduct(e).dot(scaled.ldlt().solve(d.cwiseProduct(e)));
  }
};

/// A body at constant velocity and rate, on level ground, among points at 2 to 8 m.
struct SteadyFlight {
  Vector3 velocity = Vector3::Zero();  ///< in W
  Vector3 rate = Vector3::Zero();      ///< about axes of W
  double outliers = 0.01;
  std::uint64_t seed = 1;

  /// Two seconds at 10 Hz; two cameras, 11 cm apart, in the body's origin, looking along x.
  [[nodiscard]] Viotracks Record() const {
    sim::NoiseSource random(seed, 5);
    Viotracks r;
    r.imu_noise = ImuNoise();
    ViotracksCamera left;
    left.fx = left.fy = 460.0;
    left.cx = 376.0;
    left.cy = 240.0;
    left.width = 752;
    left.height = 480;
    Matrix3 R_b_c;
    R_b_c << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    left.T_b_c = Pose(R_b_c, Vector3::Zero());
    ViotracksCamera right = left;
    right.T_b_c.p() = Vector3(0.0, -0.11, 0.0);
    r.cameras = {left, right};
    const Vector3 ba = random.Normal3(0.1), bg = random.Normal3(0.01);
    for (int k = 0; k <= 420; ++k) {
      const double t = 0.005 * k;
      const Matrix3 R = so3::Exp(Vector3(rate * t));
      r.imu.push_back(
          {.stamp_ns = std::int64_t{5'000'000} * k,
           .gyro = R.transpose() * rate + bg + random.Normal3(1.7e-4 * std::sqrt(200.0)),
           .accel =
               R.transpose() * Vector3(0, 0, 9.81) + ba + random.Normal3(2e-3 * std::sqrt(200.0))});
    }
    std::vector<Vector3> points;
    for (int j = 0; j < 300; ++j) {
      const double depth = random.Uniform(2.0, 8.0), bearing = random.Uniform(-1.5, 1.5);
      points.emplace_back(depth * std::cos(bearing), depth * std::sin(bearing),
                          random.Uniform(-0.45, 0.45) * depth);
    }
    for (int k = 0; k <= 20; ++k) {
      const double t = 0.1 * k;
      const Pose T_w_b(so3::Exp(Vector3(rate * t)), Vector3(velocity * t));
      r.frames.push_back({k, std::int64_t{100'000'000} * k});
      r.ground_truth.push_back({.stamp_ns = std::int64_t{100'000'000} * k,
                                .T_w_b = T_w_b,
                                .speed_bias = VertexSpeedBias(velocity, ba, bg)});
      for (std::size_t j = 0; j < points.size(); ++j) {
        for (int c = 0; c < 2; ++c) {
          const ViotracksCamera& camera = r.cameras[static_cast<std::size_t>(c)];
          const Vector3 x = (T_w_b * camera.T_b_c).Inverse() * points[j];
          double u = camera.fx * x[0] / x[2] + camera.cx, v = camera.fy * x[1] / x[2] + camera.cy;
          if (!(x[2] > 0.3 && u > 0 && u < camera.width && v > 0 && v < camera.height)) continue;
          u += random.Normal(1.0);
          v += random.Normal(1.0);
          if (random.Uniform(0.0, 1.0) < outliers) u = random.Uniform(0.0, camera.width);
          r.tracks.push_back({k, static_cast<std::int32_t>(j), c, u, v});
        }
      }
    }
    return r;
  }
};

}  // namespace glissade::test
