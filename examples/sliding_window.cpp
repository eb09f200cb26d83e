// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A visual-inertial sliding window: a keyframe comes, a solve, the oldest keyframe goes and leaves
// a prior. The flight is simulated; what a front end would say is in `data`.
#include <glissade/edges/imu.h>
#include <glissade/edges/speed_bias_prior.h>
#include <glissade/glissade.h>
#include <glissade/sim/vi_world.h>

#include <cstdio>
#include <cstdlib>
#include <deque>
#include <vector>

using namespace glissade;

namespace {

constexpr std::size_t kWindow = 7;  // keyframes

/// Ends the program where something was refused: the message says what, and why.
void Check(const Status& status) {
  if (status.ok()) return;
  std::printf("%s\n", status.message().c_str());
  std::exit(1);
}

struct Keyframe {
  VertexHandle<VertexPose> pose;
  VertexHandle<VertexSpeedBias> speed_bias;
  std::vector<std::size_t> points;  ///< that it sees
};

}  // namespace

int main() {
  sim::ViWorldOptions options;
  options.num_keyframes = 40;
  options.length_m = 20.0;
  options.num_points = 200;
  options.pixel_noise = options.camera.sigma_px = 1.0;
  options.imu_noise = ImuNoise();  // a good MAV's
  const auto world = sim::MakeViWorld(options);
  if (!world.ok()) return 1;
  const auto data = sim::Measure(*world, 1);
  if (!data.ok()) return 1;
  const sim::ViCamera& camera = data->cameras[0];
  const Matrix2 per_pixel = Vector2(camera.fx, camera.fy).asDiagonal() * (1.0 / camera.sigma_px);

  Problem problem;
  // A prior was linearized once. Whatever it touches stays linearized there, or the sum of prior
  // and measurements claims to see where north is (docs/marginalization.md).
  problem.SetFirstEstimates(FirstEstimates::kFull);
  std::deque<Keyframe> window;
  std::vector<VertexHandle<VertexPointXYZ>> points(data->start.points.size());
  std::vector<bool> gone(points.size(), false);
  double squares = 0.0;
  std::size_t marginalized = 0;

  for (std::size_t k = 0; k < data->stamps_ns.size(); ++k) {
    // 1. The keyframe where the IMU says that it is, from where the last one is now.
    Keyframe frame;
    VertexPose pose = data->truth.poses[k];
    VertexSpeedBias speed_bias = data->truth.speed_biases[k];
    if (k > 0) {
      const Keyframe& last = window.back();
      const ImuPrediction predicted =
          Predict(data->imu[k - 1].edge, problem.Get(last.pose), problem.Get(last.speed_bias));
      pose = predicted.pose;
      speed_bias = predicted.speed_bias;
    }
    frame.pose = problem.AddVertex(pose);
    frame.speed_bias = problem.AddVertex(speed_bias);
    if (k == 0) {
      // Where we begin is where we say; speed and biases are known roughly.
      EdgeSE3Prior begin;
      begin.T_w_b = pose.pose;
      Check(problem
                .AddEdge(begin, {frame.pose},
                         {.sqrt_information = SquareMatrix<6>(1e3 * SquareMatrix<6>::Identity())})
                .status());
      Check(problem
                .AddEdge(EdgeSpeedBiasPrior{speed_bias}, {frame.speed_bias},
                         {.sqrt_information = SquareMatrix<9>(20.0 * SquareMatrix<9>::Identity())})
                .status());
    } else {
      const Keyframe& last = window.back();
      Check(problem
                .AddEdge(data->imu[k - 1].edge,
                         {last.pose, last.speed_bias, frame.pose, frame.speed_bias},
                         data->imu[k - 1].options)
                .status());
    }

    // 2. What it sees. A point that went with an old keyframe is in the prior: not a second time.
    for (const sim::ViObservation& o : data->observations) {
      if (static_cast<std::size_t>(o.keyframe) != k) continue;
      const auto p = static_cast<std::size_t>(o.point);
      if (gone[p]) continue;
      if (!problem.Contains(points[p])) points[p] = problem.AddVertex(data->start.points[p]);
      EdgeReprojectionXYZ edge;
      edge.T_b_c = camera.T_b_c;
      edge.uv = Vector2((o.u - camera.cx) / camera.fx, (o.v - camera.cy) / camera.fy);
      Check(problem
                .AddEdge(edge, {frame.pose, points[p]},
                         {.sqrt_information = per_pixel, .loss = Huber{2.0}})
                .status());
      frame.points.push_back(p);
    }
    window.push_back(frame);

    // 3. Solve.
    const SolveSummary& summary = problem.Solve({.max_iterations = 8});
    if (!summary.ok()) {
      std::printf("keyframe %zu: %s\n", k, summary.status.message().c_str());
      return 1;
    }
    const double error = (problem.Get(frame.pose).pose.p() - data->truth.poses[k].pose.p()).norm();
    squares += error * error;
    if (k % 8 == 7) {
      std::printf("keyframe %2zu: position off by %5.1f mm after %4.1f m; %s\n", k, 1e3 * error,
                  0.5 * static_cast<double>(k), summary.BriefReport().c_str());
    }

    // 4. The oldest goes, with the points it has seen. What they knew stays as a prior.
    if (window.size() < kWindow) continue;
    std::vector<AnyVertex> going = {window.front().pose, window.front().speed_bias};
    for (const std::size_t p : window.front().points) {
      if (!gone[p] && problem.Contains(points[p])) going.emplace_back(points[p]);
      gone[p] = true;
    }
    const auto done = problem.Marginalize(going);
    if (!done.ok()) {
      std::printf("keyframe %zu: %s\n", k, done.status().message().c_str());
      return 1;
    }
    marginalized += going.size();
    window.pop_front();
  }

  const double rms = std::sqrt(squares / static_cast<double>(data->stamps_ns.size()));
  std::printf("%zu vertices marginalized; newest keyframe's position: %.1f mm RMS\n", marginalized,
              1e3 * rms);
  return rms < 0.2 ? 0 : 1;
}
