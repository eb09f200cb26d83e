// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "glissade/vision/camera.h"
#include "glissade/vision/image.h"

namespace glissade::vision::test {

/// Smooth random grey values in the plane: bicubic-like blends of a lattice of hashes.
class Paint {
 public:
  explicit Paint(double cell_m) : cell_m_(cell_m) {}

  /// 0 to 255.
  [[nodiscard]] double operator()(double x, double y) const {
    x /= cell_m_;
    y /= cell_m_;
    const double x0 = std::floor(x), y0 = std::floor(y);
    const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
    const double a = smooth(x - x0), b = smooth(y - y0);
    const auto at = [&](double i, double j) {
      auto h = static_cast<std::uint32_t>(static_cast<std::int64_t>(x0 + i) * 73856093 ^
                                          static_cast<std::int64_t>(y0 + j) * 19349663);
      h ^= h >> 13;
      h *= 0x5bd1e995u;
      h ^= h >> 15;
      return static_cast<double>(h % 256);
    };
    return (1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) + b * ((1 - a) * at(0, 1) + a * at(1, 1));
  }

 private:
  double cell_m_;
};

/// A painted wall at z = 4 m of the world (x right, y down, z forward), as a camera sees it that
/// stands there, with independent noise of that sigma (grey values).
inline Image SeeWall(const Camera& camera, const Pose& T_w_c, double noise = 1.0,
                     std::uint32_t seed = 1, double depth_m = 4.0) {
  const Paint paint(0.12);
  Image image;
  image.width = camera.width;
  image.height = camera.height;
  std::uint32_t state = seed * 2654435761u + 1u;
  const auto uniform = [&] {
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state >> 8) / (1 << 24) - 0.5;
  };
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double uv[2] = {static_cast<double>(u), static_cast<double>(v)};
      double xy[2] = {0.0, 0.0}, grey = 0.0;
      if (camera.Undistort(uv, xy)) {
        const Vector3 ray = T_w_c.q() * Vector3(xy[0], xy[1], 1.0);
        const double s = (depth_m - T_w_c.p()[2]) / ray[2];
        grey = paint(T_w_c.p()[0] + s * ray[0], T_w_c.p()[1] + s * ray[1]);
      }
      grey += noise * (uniform() + uniform() + uniform() + uniform()) * std::sqrt(3.0);
      image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(grey + 0.5, 0.0, 255.0)));
    }
  }
  return image;
}

/// 240 x 180 px, looking along the body's z.
inline Camera SmallCamera() {
  Camera camera;
  camera.lens = CameraRadtan{{180.0, 180.0, 119.5, 89.5}, -0.28, 0.07, 2e-4, 2e-5, 0.0};
  camera.width = 240;
  camera.height = 180;
  return camera;
}

}  // namespace glissade::vision::test
