// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "glissade/lie/so3.h"
#include "glissade/window/data_doctor.h"

namespace glissade::test {

/// A stereo camera with an IMU that somebody turns and waves in a room, as the data doctor takes
/// it. Members may be broken at will; Input() points to them.
struct ShakenRecording {
  std::vector<ImuSample> imu;
  ImuNoise noise;
  double rate_hz = 200.0;
  std::vector<std::int64_t> stamps;
  std::vector<std::vector<FrameObservation>> observations;  ///< by frame
  std::vector<WindowCamera> cameras;
  std::vector<DoctorImageSize> sizes;
  Vector3 gravity = Vector3(0.0, 0.0, -9.81);
  std::vector<FrameObservations> frames;

  struct Motion {
    double rate = 1.0;    ///< of the rotation, about, rad/s
    bool planar = false;  ///< about the vertical only
  };

  explicit ShakenRecording(std::uint64_t seed, double frame_hz = 10.0, double seconds = 12.0)
      : ShakenRecording(seed, frame_hz, seconds, Motion()) {}
  ShakenRecording(std::uint64_t seed, double frame_hz, double seconds, Motion motion)
      : rng_(seed), motion_(motion) {
    MakeCameras();
    for (double& phase : phases_)
      phase = std::uniform_real_distribution<double>(0.0, 6.28)(rng_);
    MakeImu(seconds);
    MakeTracks(frame_hz, seconds);
  }

  DoctorInput Input() {
    frames.clear();
    for (std::size_t k = 0; k < stamps.size(); ++k)
      frames.push_back({stamps[k], observations[k]});
    DoctorInput input;
    input.imu = imu;
    input.imu_noise = noise;
    input.imu_rate_hz = rate_hz;
    input.frames = frames;
    input.cameras = cameras;
    input.image_sizes = sizes;
    input.gravity = gravity;
    return input;
  }

 private:
  /// Three angles that wave, as a rotation vector in the world, and their derivative.
  [[nodiscard]] Vector3 AnglesAt(double t, Vector3* rate) const {
    const double f[3] = {2.1, 2.7, 1.6};  // rad/s
    Vector3 a;
    for (int i = 0; i < 3; ++i) {
      const double size = motion_.planar && i < 2 ? 0.0 : 0.6 * motion_.rate / f[i];
      const double phase = f[i] * t + phases_[i];
      a[i] = size * (std::sin(phase) + 0.3 * std::sin(1.7 * phase));
      (*rate)[i] = size * f[i] * (std::cos(phase) + 0.51 * std::cos(1.7 * phase));
    }
    return a;
  }
  [[nodiscard]] Pose PoseAt(double t) const {
    Vector3 rate;
    const Matrix3 R = so3::Exp(AnglesAt(t, &rate));
    Vector3 p;
    for (int i = 0; i < 3; ++i)
      p[i] = 0.4 * std::sin((1.1 + 0.2 * i) * t + phases_[3 + i]);
    return Pose(R, p);
  }
  double Normal(double sigma) { return std::normal_distribution<double>(0.0, sigma)(rng_); }

  void MakeCameras() {
    Matrix3 forward;  // x right, y down, z along the body's x
    forward << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    const Matrix3 R = so3::Exp(Vector3(0.02, -0.03, 0.05)) * forward;
    for (int k = 0; k < 2; ++k) {
      cameras.push_back({460.0, 458.0, 376.0, 240.0, 1.0,
                         Pose(R, Vector3(Vector3(0.1, 0.02, 0.0) + R * Vector3(0.12 * k, 0, 0)))});
      sizes.push_back({752, 480});
    }
  }
  void MakeImu(double seconds) {
    const Vector3 ba(0.05, -0.08, 0.04), bg(0.01, -0.006, 0.004);
    const double root_rate = std::sqrt(rate_hz);
    for (int k = -100; k <= static_cast<int>((seconds + 0.5) * rate_hz); ++k) {
      const double t = k / rate_hz;
      Vector3 rate;
      const Vector3 angles = AnglesAt(t, &rate);
      Vector3 a;
      for (int i = 0; i < 3; ++i) {
        const double f = 1.1 + 0.2 * i;
        a[i] = -0.4 * f * f * std::sin(f * t + phases_[3 + i]);
      }
      ImuSample s;
      s.stamp_ns = kStart + std::llround(1e9 * t);
      s.gyro = so3::Jr(angles) * rate + bg;
      s.accel = so3::Exp(angles).transpose() * (a - gravity) + ba;
      for (int i = 0; i < 3; ++i) {
        s.gyro[i] += Normal(noise.gyro_noise_density * root_rate);
        s.accel[i] += Normal(noise.accel_noise_density * root_rate);
      }
      imu.push_back(s);
    }
  }
  void MakeTracks(double frame_hz, double seconds) {
    std::vector<Vector3> points;
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    for (int k = 0; k < 500; ++k) {
      const Vector3 direction = Vector3(u(rng_), u(rng_), u(rng_)).normalized();
      points.emplace_back((3.0 + 2.5 * (1.0 + u(rng_))) * direction);
    }
    std::map<std::size_t, std::pair<std::int64_t, int>> track_of;  // point -> track, last frame
    std::int64_t next = 0;
    for (int k = 0; k <= static_cast<int>(seconds * frame_hz); ++k) {
      const double t = k / frame_hz;
      stamps.push_back(kStart + std::llround(1e9 * t));
      auto& frame = observations.emplace_back();
      const Pose T_w_b = PoseAt(t);
      for (std::size_t i = 0; i < points.size(); ++i) {
        for (int camera = 0; camera < 2; ++camera) {
          const WindowCamera& c = cameras[static_cast<std::size_t>(camera)];
          const Vector3 x = (T_w_b * c.T_b_c).Inverse() * points[i];
          if (x[2] < 0.5) continue;
          const double px = c.fx * x[0] / x[2] + c.cx + Normal(c.sigma_px);
          const double py = c.fy * x[1] / x[2] + c.cy + Normal(c.sigma_px);
          if (px < 0.0 || py < 0.0 || px > 751.0 || py > 479.0) continue;
          auto [at, is_new] = track_of.try_emplace(i, next, k);
          if (!is_new && at->second.second < k - 1) at->second.first = next;
          if (at->second.first == next) ++next;
          at->second.second = k;
          frame.push_back({at->second.first, camera, px, py});
        }
      }
    }
  }

  static constexpr std::int64_t kStart = 1'403'636'579'758'555'392;
  std::mt19937_64 rng_;
  Motion motion_;
  double phases_[6] = {};
};

}  // namespace glissade::test
