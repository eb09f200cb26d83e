// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/bal_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "glissade/lie/so3.h"
#include "glissade/sim/noise_source.h"

namespace glissade::sim {

namespace {

struct Camera {
  Matrix3 R;  // world to camera, which looks along its -z axis, y up
  Vector3 t;
  double f, k1, k2;
};

Camera OnRing(int k, int n, NoiseSource* random) {
  const double angle = 2.0 * std::numbers::pi * k / n;
  const Vector3 centre(10.0 * std::cos(angle), 10.0 * std::sin(angle), random->Normal(0.5));
  const Vector3 back = centre.normalized();
  const Vector3 right = Vector3(0.0, 0.0, 1.0).cross(back).normalized();
  const Vector3 up = back.cross(right);
  Camera camera;
  camera.R << right.transpose(), up.transpose(), back.transpose();
  camera.t = -(camera.R * centre);
  camera.f = 600.0 + random->Normal(20.0);
  camera.k1 = -0.05 + random->Normal(0.01);
  camera.k2 = 0.01;
  return camera;
}

BalObservation Observe(const Camera& camera, const Vector3& X) {
  const Vector3 P = camera.R * X + camera.t;
  const double x = -P[0] / P[2], y = -P[1] / P[2];
  const double s = x * x + y * y;
  const double scale = camera.f * (1.0 + camera.k1 * s + camera.k2 * s * s);
  return {0, 0, scale * x, scale * y};
}

double Rounded(double x) {
  return std::round(x * 256.0) / 256.0;
}

}  // namespace

Status BalSceneOptions::Validate() const {
  const auto wrong = [](const char* what) {
    return Status(StatusCode::kInvalidArgument, std::string("scene: ") + what);
  };
  if (num_cameras < 3 || num_cameras > 10000) return wrong("num_cameras must be 3 to 10000");
  if (num_points < 1 || num_points > 10000000) return wrong("num_points must be 1 to 10000000");
  if (!(part_seen > 0.0 && part_seen <= 1.0)) return wrong("part_seen must be 0 to 1");
  for (const double x : {pixel_noise, start_point_m, start_rotation_rad, start_translation_m}) {
    if (!(x >= 0.0 && std::isfinite(x))) return wrong("noise must be >= 0");
  }
  return {};
}

Result<BalProblem> MakeBalScene(const BalSceneOptions& options) {
  if (Status s = options.Validate(); !s.ok()) return s;
  NoiseSource random(options.seed, 30), start(options.seed, 31);
  std::vector<Camera> cameras;
  BalProblem problem;
  for (int k = 0; k < options.num_cameras; ++k) {
    const Camera& c = cameras.emplace_back(OnRing(k, options.num_cameras, &random));
    const Vector3 w = so3::Log(c.R) + start.Normal3(options.start_rotation_rad);
    const Vector3 t = c.t + start.Normal3(options.start_translation_m);
    VertexCameraBal vertex;
    const double data[9] = {w[0], w[1], w[2], t[0], t[1], t[2], c.f, c.k1, c.k2};
    std::copy_n(data, 9, vertex.data);
    problem.cameras.push_back(vertex);
  }
  for (int j = 0; j < options.num_points; ++j) {
    const Vector3 X = 4.0 * std::cbrt(random.Uniform(0.0, 1.0)) * random.Direction();
    problem.points.emplace_back(Vector3(X + start.Normal3(options.start_point_m)));
    // Neighbours on the ring see it, from a random one on.
    const int seen =
        std::clamp(static_cast<int>(std::lround(options.part_seen * options.num_cameras)), 3,
                   options.num_cameras);
    const int first = static_cast<int>(random.Uniform(0.0, options.num_cameras));
    for (int k = 0; k < seen; ++k) {
      const int camera = (first + k) % options.num_cameras;
      BalObservation o = Observe(cameras[static_cast<std::size_t>(camera)], X);
      o.camera = camera;
      o.point = j;
      o.u = Rounded(o.u + random.Normal(options.pixel_noise));
      o.v = Rounded(o.v + random.Normal(options.pixel_noise));
      problem.observations.push_back(o);
    }
  }
  return problem;
}

}  // namespace glissade::sim
