// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "common/random_states.h"
#include "glissade/eval/association.h"
#include "glissade/lie/so3.h"

namespace glissade::eval {

using Engine = test::Random;

/// Normal with deviation sigma (Box and Muller).
inline double Normal(Engine& engine, double sigma) {
  const double r = std::sqrt(-2.0 * std::log(1.0 - engine.Uniform(0.0, 1.0)));
  return sigma * r * std::cos(engine.Uniform(0.0, 2.0 * std::numbers::pi));
}

inline Vector3 RandomVector(Engine& engine, double sigma) {
  const double x = Normal(engine, sigma), y = Normal(engine, sigma), z = Normal(engine, sigma);
  return {x, y, z};
}

inline Pose RandomPose(Engine& engine, double sigma_p, double sigma_theta) {
  return {so3::ExpQuaternion(RandomVector(engine, sigma_theta)), RandomVector(engine, sigma_p)};
}

/// n poses, step_ns apart: a random walk of position and rotation.
inline Trajectory RandomTrajectory(Engine& engine, int n, std::int64_t step_ns = 100'000'000,
                                   std::int64_t start_ns = 1403636579763555584) {
  Trajectory trajectory;
  StampedPose x{start_ns, RandomPose(engine, 5.0, 2.0)};
  for (int k = 0; k < n; ++k) {
    trajectory.push_back(x);
    x.stamp_ns += step_ns;
    x.T_w_b = x.T_w_b * RandomPose(engine, 0.3, 0.2);
    x.T_w_b.Normalize();
  }
  return trajectory;
}

/// x moved by noise in position and rotation, pose by pose.
inline Trajectory Noisy(Engine& engine, Trajectory x, double sigma_p, double sigma_theta) {
  for (StampedPose& pose : x) {
    pose.T_w_b.p() += RandomVector(engine, sigma_p);
    pose.T_w_b =
        pose.T_w_b * Pose(so3::ExpQuaternion(RandomVector(engine, sigma_theta)), {0, 0, 0});
    pose.T_w_b.Normalize();
  }
  return x;
}

}  // namespace glissade::eval
