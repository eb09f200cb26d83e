// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vi_world_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "glissade/sim/noise_source.h"

namespace glissade::sim::internal {

namespace {

/// Walls, floor and ceiling: a box around the flight.
struct Room {
  double low[3], high[3];

  Room(const ViWorldOptions& options, const Trajectory& path) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::numeric_limits<double>::infinity();
      high[i] = -low[i];
    }
    constexpr int kSteps = 200;
    for (int k = 0; k <= kSteps; ++k) {
      const Vector3 p = path.PoseAt(path.Duration() * k / kSteps).p();
      for (int i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], p[i]);
        high[i] = std::max(high[i], p[i]);
      }
    }
    for (int i = 0; i < 3; ++i) {
      const double margin = i == 2 ? options.floor_distance_m : options.wall_distance_m;
      low[i] -= margin;
      high[i] += margin;
    }
  }

  /// Where the ray from inside leaves the room; the axis of that plane in *axis.
  [[nodiscard]] Vector3 Hit(const Vector3& origin, const Vector3& ray, int* axis) const {
    double nearest = std::numeric_limits<double>::infinity();
    *axis = 0;
    for (int i = 0; i < 3; ++i) {
      if (ray[i] == 0.0) continue;
      const double distance = ((ray[i] > 0.0 ? high[i] : low[i]) - origin[i]) / ray[i];
      if (distance < nearest) {
        nearest = distance;
        *axis = i;
      }
    }
    return origin + nearest * ray;
  }
};

/// Where camera `c` at T_w_c sees X; false where it does not.
bool Project(const ViWorldOptions& options, const Pose& T_c_w, const Vector3& X, double* u,
             double* v) {
  const ViCamera& c = options.camera;
  const Vector3 x = T_c_w * X;
  if (!(x[2] >= options.nearest_visible_m)) return false;
  *u = c.fx * x[0] / x[2] + c.cx;
  *v = c.fy * x[1] / x[2] + c.cy;
  return *u >= 0.0 && *u < c.width && *v >= 0.0 && *v < c.height;
}

}  // namespace

Status AddPoints(const ViWorldOptions& options, const Trajectory& path, ViProblem* exact) {
  const ViCamera& camera = options.camera;
  NoiseSource random(options.seed, 1);
  const Room room(options, path);
  std::vector<Pose> T_c_w;
  for (const VertexPose& pose : exact->truth.poses)
    T_c_w.push_back((pose.pose * camera.T_b_c).Inverse());

  std::vector<ViObservation> seen;
  const int most_draws = 1000 * options.num_points;
  for (int draw = 0; static_cast<int>(exact->truth.points.size()) < options.num_points; ++draw) {
    if (draw == most_draws) {
      return {StatusCode::kInvalidArgument,
              "world: only " + std::to_string(exact->truth.points.size()) + " of " +
                  std::to_string(options.num_points) + " points are seen from " +
                  std::to_string(options.min_observations) + " keyframes"};
    }
    // A pixel at a moment of the flight, and a depth along its ray.
    const Pose T_w_c = path.PoseAt(random.Uniform(0.0, path.Duration())) * camera.T_b_c;
    const Vector3 ray_c((random.Uniform(0.0, camera.width) - camera.cx) / camera.fx,
                        (random.Uniform(0.0, camera.height) - camera.cy) / camera.fy, 1.0);
    const Vector3 ray = T_w_c.R() * ray_c;
    Vector3 X;
    if (options.points == PointLayout::kRandom) {
      X = T_w_c.p() + random.Uniform(options.min_depth_m, options.max_depth_m) * ray;
    } else {
      int axis = 0;
      X = room.Hit(T_w_c.p(), ray, &axis);
      X[axis] += random.Normal(options.plane_roughness_m);
    }
    seen.clear();
    for (std::size_t k = 0; k < T_c_w.size(); ++k) {
      ViObservation o;
      o.keyframe = static_cast<std::int32_t>(k);
      o.point = static_cast<std::int32_t>(exact->truth.points.size());
      if (Project(options, T_c_w[k], X, &o.u, &o.v)) seen.push_back(o);
    }
    if (static_cast<int>(seen.size()) < options.min_observations) continue;
    exact->truth.points.emplace_back(X);
    exact->observations.insert(exact->observations.end(), seen.begin(), seen.end());
  }
  std::stable_sort(
      exact->observations.begin(), exact->observations.end(),
      [](const ViObservation& a, const ViObservation& b) { return a.keyframe < b.keyframe; });
  return {};
}

}  // namespace glissade::sim::internal
