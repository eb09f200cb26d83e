// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "common/random_states.h"
#include "glissade/io/g2o.h"

/// \file
/// Costs of a g2o problem by the formulas of its edges, with Eigen's transforms and nothing of the
/// library's edges; and pose graphs to solve.
namespace glissade::test {

inline Eigen::Isometry3d TransformOf(const Pose& pose) {
  const double* x = pose.data;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(x[6], x[3], x[4], x[5]).normalized().toRotationMatrix();
  T.translation() = Eigen::Vector3d(x[0], x[1], x[2]);
  return T;
}

template <class List>
const auto& ById(const List& list, std::int64_t id) {
  for (const auto& x : list) {
    if (x.id == id) return x;
  }
  return list.front();
}

template <int N, std::size_t Size>
double QuadraticForm(const std::array<double, Size>& triangle,
                     const Eigen::Matrix<double, N, 1>& e) {
  double sum = 0.0;
  std::size_t k = 0;
  for (int r = 0; r < N; ++r) {
    for (int c = r; c < N; ++c)
      sum += (r == c ? 1.0 : 2.0) * triangle[k++] * e[r] * e[c];
  }
  return sum;
}

/// [translation, half the rotation: as g2o has it (the vector part of the quaternion), or half the
/// angle].
inline Eigen::Matrix<double, 6, 1> ErrorOf(const Eigen::Isometry3d& delta, bool half_angle) {
  Eigen::Quaterniond q(delta.linear());
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  Eigen::Matrix<double, 6, 1> e;
  e.head<3>() = delta.translation();
  e.tail<3>() = q.vec();
  const double n = q.vec().norm();
  if (half_angle && n > 0.0) e.tail<3>() *= std::atan2(n, q.w()) / n;
  return e;
}

inline double G2oChi2(const G2oProblem& p, const G2oRelativePose& x, bool half_angle = false) {
  const Eigen::Isometry3d delta = TransformOf(x.T_i_j).inverse() *
                                  TransformOf(ById(p.poses, x.from).T_w_b).inverse() *
                                  TransformOf(ById(p.poses, x.to).T_w_b);
  return QuadraticForm<6>(x.information, ErrorOf(delta, half_angle));
}
inline double G2oChi2(const G2oProblem& p, const G2oPosePrior& x, bool half_angle = false) {
  const Eigen::Isometry3d delta = TransformOf(x.T_w_s).inverse() *
                                  TransformOf(ById(p.poses, x.pose).T_w_b) *
                                  TransformOf(ById(p.offsets, x.offset).T_b_s);
  return QuadraticForm<6>(x.information, ErrorOf(delta, half_angle));
}
inline double G2oChi2(const G2oProblem& p, const G2oPointMeasurement& x) {
  const Eigen::Isometry3d T_w_s =
      TransformOf(ById(p.poses, x.pose).T_w_b) * TransformOf(ById(p.offsets, x.offset).T_b_s);
  const Eigen::Vector3d p_s = T_w_s.inverse() * Eigen::Vector3d(ById(p.points, x.point).xyz);
  return QuadraticForm<3>(x.information, Eigen::Vector3d(p_s - Eigen::Vector3d(x.xyz)));
}
inline double G2oChi2(const G2oProblem& p, const G2oProjection& x) {
  const G2oCamera& camera = ById(p.cameras, x.camera);
  const Eigen::Vector3d p_c =
      TransformOf(camera.T_w_c).inverse() * Eigen::Vector3d(ById(p.points, x.point).xyz);
  return QuadraticForm<2>(x.information,
                          Eigen::Vector2d(camera.fx * p_c[0] / p_c[2] + camera.cx - x.u,
                                          camera.fy * p_c[1] / p_c[2] + camera.cy - x.v));
}

/// 1/2 sum of chi2 with rotation errors by their angles: what AddToGraph makes of the problem.
inline double OurG2oCost(const G2oProblem& p) {
  double sum = 0.0;
  for (const auto& x : p.relative_poses)
    sum += G2oChi2(p, x, true);
  for (const auto& x : p.priors)
    sum += G2oChi2(p, x, true);
  for (const auto& x : p.point_measurements)
    sum += G2oChi2(p, x);
  for (const auto& x : p.projections)
    sum += G2oChi2(p, x);
  return 0.5 * sum;
}

/// A helix of poses with odometry, closures from turn to turn, and points that a tilted sensor sees
/// from several poses; measurements with noise of their information, poses integrated from them.
inline G2oProblem MakeG2oScene(int num_poses, std::uint64_t seed) {
  Random random(seed);
  const auto noisy = [&](const Pose& T, double translation, double rotation) {
    Pose out = T * Pose(random.Rotation(random.Uniform(0.0, rotation)), random.Vec3(translation));
    out.Normalize();
    return out;
  };
  // Uniform in +-a has the variance a^2 / 3; the rotation's is g2o's, of half the angle.
  std::array<double, 21> information{};
  for (const std::size_t k : {0u, 6u, 11u})
    information[k] = 3.0 / (0.05 * 0.05);
  for (const std::size_t k : {15u, 18u, 20u})
    information[k] = 4.0 * 9.0 / (0.03 * 0.03);
  information[1] = information[3] = information[17] = 40.0;

  G2oProblem p;
  std::vector<Pose> truth;
  constexpr int kTurn = 10;
  for (int k = 0; k < num_poses; ++k) {
    const double a = 2.0 * std::numbers::pi * k / kTurn;
    truth.emplace_back(Quaternion(so3::ExpQuaternion(Vector3(0.0, 0.0, a))),
                       Vector3(3.0 * std::cos(a), 3.0 * std::sin(a), 0.1 * k));
  }
  p.poses.push_back({100, truth[0], false});
  const auto measure = [&](int i, int j) {
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
    p.relative_poses.push_back(
        {100 + i, 100 + j, noisy(truth[a].Inverse() * truth[b], 0.05, 0.03), information});
  };
  for (int k = 1; k < num_poses; ++k) {
    measure(k - 1, k);
    Pose T_w_k = p.poses.back().T_w_b * p.relative_poses.back().T_i_j;
    T_w_k.Normalize();
    p.poses.push_back({100 + k, T_w_k, false});
  }
  for (int k = kTurn; k < num_poses; k += 3)
    measure(k - kTurn, k);
  p.offsets.push_back({0, Pose(random.Rotation(0.3), Vector3(0.1, 0.0, 0.05))});
  for (int n = 0; n < 5; ++n) {
    const Vector3 x = random.Vec3(4.0);
    p.points.push_back({n, {x[0] + 0.2, x[1] - 0.2, x[2]}, false, false});
    for (int k = n; k < num_poses; k += 4) {
      const Vector3 seen = (truth[static_cast<std::size_t>(k)] * p.offsets[0].T_b_s).Inverse() * x +
                           random.Vec3(0.05);
      p.point_measurements.push_back({100 + k, n, 0, {seen[0], seen[1], seen[2]}, {}});
      p.point_measurements.back().information = {1200.0, 100.0, 0.0, 1200.0, 0.0, 900.0};
    }
  }
  return p;
}

}  // namespace glissade::test
