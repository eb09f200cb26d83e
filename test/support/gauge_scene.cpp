// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/gauge_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/graph_random.h"

namespace glissade::test {

namespace {

constexpr double kInterval = 0.25;  // s
constexpr double kFocal = 460.0;    // px
const Vector3 kGravity(0.0, 0.0, -9.81);

struct Frame {
  Pose T_w_b;
  Vector3 v;
};

/// A wavy path, 2 m/s.
Frame FrameAt(double t) {
  Frame frame;
  const double w = 1.1;
  const Vector3 p(2.0 * t, 0.6 * std::sin(w * t), 0.3 * std::cos(0.7 * t));
  frame.v = Vector3(2.0, 0.6 * w * std::cos(w * t), -0.21 * std::sin(0.7 * t));
  const Quaternion q = so3::ExpQuaternion(Vector3(0.0, 0.0, 0.4 + 0.3 * std::sin(0.9 * t))) *
                       so3::ExpQuaternion(Vector3(0.08 * std::sin(t), 0.1 * std::cos(1.3 * t), 0));
  frame.T_w_b = Pose(q, p);
  return frame;
}

PreintegratedImu Between(const Frame& a, const Frame& b, GraphRandom* random, double noise) {
  PreintegratedImu imu;
  const double dt = imu.dt = kInterval;
  const Matrix3 R = a.T_w_b.R().transpose();
  imu.dp = R * (b.T_w_b.p() - a.T_w_b.p() - dt * a.v - 0.5 * dt * dt * kGravity) +
           random->NormalVector<3>(noise * 2e-3);
  imu.dv = R * (b.v - a.v - dt * kGravity) + random->NormalVector<3>(noise * 5e-3);
  imu.dq = Quaternion(a.T_w_b.q().conjugate() * b.T_w_b.q()) *
           so3::ExpQuaternion(random->NormalVector<3>(noise * 1e-3));
  imu.dp_dba = -0.5 * dt * dt * Matrix3::Identity();
  imu.dv_dba = -dt * Matrix3::Identity();
  imu.dq_dbg = -dt * Matrix3::Identity();
  imu.dv_dbg = 0.5 * dt * dt * so3::Hat(Vector3(0.3, -0.2, 9.8));
  imu.dp_dbg = dt * dt * dt / 6.0 * so3::Hat(Vector3(0.3, -0.2, 9.8));
  return imu;
}

}  // namespace

GaugeScene::GaugeScene(std::uint64_t seed, const GaugeSceneOptions& options) {
  GraphRandom random(seed);
  // The camera looks to the left of the way: parallax.
  Matrix3 R_b_c;
  R_b_c << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  T_b_c = Pose(R_b_c, options.lever ? Vector3(0.12, -0.05, 0.03) : Vector3(0.0, 0.0, 0.0));
  std::vector<Frame> frames;
  const auto must = [](const auto& result) { EXPECT_TRUE(result.ok()); };
  for (int k = 0; k < options.num_frames; ++k) {
    frames.push_back(FrameAt(kInterval * k));
    const Frame& frame = frames.back();
    poses.push_back(problem.AddVertex(
        VertexPose{random.Perturb(frame.T_w_b, 10.0 * options.start_noise, options.start_noise)}));
    if (!options.imu) continue;
    speeds.push_back(problem.AddVertex(
        VertexSpeedBias(frame.v + random.NormalVector<3>(10.0 * options.start_noise),
                        Vector3(0.0, 0.0, 0.0), Vector3(0.0, 0.0, 0.0))));
    if (!options.biases) {
      EXPECT_TRUE(problem.SetFixed(speeds.back(), Fix::kBiases).ok());
    }
  }
  for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
    if (options.imu) {
      EdgeOptions<EdgeImu> weight;
      Eigen::Matrix<double, 15, 1> inverse_sigma;
      inverse_sigma << Vector3::Constant(500.0), Vector3::Constant(1000.0),
          Vector3::Constant(200.0), Vector3::Constant(500.0), Vector3::Constant(2000.0);
      weight.sqrt_information = SquareMatrix<15>(inverse_sigma.asDiagonal());
      must(problem.AddEdge(
          EdgeImu{Between(frames[k], frames[k + 1], &random, options.noise), kGravity},
          {poses[k], speeds[k], poses[k + 1], speeds[k + 1]}, weight));
    } else if (options.relative_poses) {
      EdgeOptions<EdgeRelativePose> weight;
      weight.sqrt_information = 100.0 * Matrix6::Identity();
      const Pose exact = frames[k].T_w_b.Inverse() * frames[k + 1].T_w_b;
      must(problem.AddEdge(
          EdgeRelativePose{random.Perturb(exact, 0.01 * options.noise, 0.01 * options.noise)},
          {poses[k], poses[k + 1]}, weight));
    }
  }
  const double sigma = options.noise / kFocal;
  for (int j = 0; j < options.num_points; ++j) {
    // In front of some frame, seen by it and those around it.
    const auto host = static_cast<std::size_t>(j * (options.num_frames - 3) / options.num_points);
    const double z = random.Uniform(4.0, 12.0);
    const Vector2 uv(random.Uniform(-0.5, 0.5), random.Uniform(-0.4, 0.4));
    const Vector3 x_w = frames[host].T_w_b * (T_b_c * Vector3(z * uv[0], z * uv[1], z));
    const auto project = [&](std::size_t k) {
      const Vector3 x_c = T_b_c.Inverse() * (frames[k].T_w_b.Inverse() * x_w);
      return Vector2(x_c.head<2>() / x_c[2] + random.NormalVector<2>(sigma));
    };
    const std::size_t last =
        std::min(frames.size(), host + static_cast<std::size_t>(options.views));
    if (options.inverse_depth) {
      const VertexHandle<VertexInverseDepth> depth =
          problem.AddVertex(VertexInverseDepth{(1.0 + 5.0 * options.start_noise) / z});
      points.emplace_back(depth);
      EdgeOptions<EdgeReprojection> weight;
      weight.sqrt_information = kFocal * Matrix2::Identity();
      for (std::size_t k = host + 1; k < last; ++k) {
        EdgeReprojection edge{.uv_host = uv, .T_b_c = T_b_c};
        edge.uv_target = project(k);
        must(problem.AddEdge(edge, {poses[host], poses[k], depth}, weight));
      }
    } else {
      const VertexHandle<VertexPointXYZ> point = problem.AddVertex(
          VertexPointXYZ(x_w + random.NormalVector<3>(10.0 * options.start_noise)));
      points.emplace_back(point);
      EdgeOptions<EdgeReprojectionXYZ> weight;
      weight.sqrt_information = kFocal * Matrix2::Identity();
      for (std::size_t k = host; k < last; ++k) {
        EdgeReprojectionXYZ edge;
        edge.uv = project(k);
        edge.T_b_c = T_b_c;
        must(problem.AddEdge(edge, {poses[k], point}, weight));
      }
    }
  }
}

SolveOptions Converge(const Gauge& gauge) {
  SolveOptions options;
  options.max_iterations = 200;
  options.cost_tolerance = 1e-15;
  options.step_tolerance = 1e-13;
  options.gauge = gauge;
  return options;
}

double YawBetween(const Pose& from, const Pose& now) {
  return so3::Log(Quaternion(now.q() * from.q().conjugate()))[2];
}

}  // namespace glissade::test
