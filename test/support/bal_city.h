// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "glissade/edges/bal.h"
#include "glissade/graph/graph.h"

namespace glissade::test {

/// A survey flight over a city: rows of BAL cameras that look down, points on roofs and streets,
/// each seen by the few cameras that are near. Noise of half a pixel, and a start some pixels off.
/// Every camera shares points with some 24 neighbours, however large the city is.
inline Graph MakeBalCity(int num_cameras, std::uint64_t seed, int points_per_camera = 12) {
  std::mt19937_64 engine(seed);
  const auto uniform = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(engine() >> 11) * 0x1.0p-53;
  };
  constexpr double kHeight = 2.0, kReach = 1.1;  // in units of the cameras' spacing
  Graph graph;
  const int width = static_cast<int>(std::ceil(std::sqrt(num_cameras)));
  struct Camera {
    double x, y;
    VertexCameraBal truth;
    VertexHandle<VertexCameraBal> handle;
  };
  std::vector<Camera> cameras;
  for (int k = 0; k < num_cameras; ++k) {
    Camera camera{static_cast<double>(k % width), static_cast<double>(k / width), {}, {}};
    double* c = camera.truth.data;
    for (int i = 0; i < 3; ++i)
      c[i] = uniform(-0.05, 0.05);
    const Vector3 centre(camera.x, camera.y, kHeight);
    const Vector3 t = -(so3::Exp(Vector3(c[0], c[1], c[2])) * centre);
    for (int i = 0; i < 3; ++i)
      c[3 + i] = t[i];
    c[6] = 500.0;
    c[7] = uniform(-0.01, 0.01);
    VertexCameraBal start = camera.truth;
    for (int i = 0; i < 3; ++i)
      start.data[i] += uniform(-1e-3, 1e-3);
    camera.handle = graph.AddVertex(start);
    cameras.push_back(camera);
  }
  for (int k = 0; k < num_cameras * points_per_camera; ++k) {
    const Vector3 X(uniform(-0.5, width - 0.5), uniform(-0.5, width - 0.5), uniform(0.0, 0.6));
    std::vector<const Camera*> seen_by;
    for (int x = static_cast<int>(std::ceil(X[0] - kReach)); x <= X[0] + kReach; ++x) {
      for (int y = static_cast<int>(std::ceil(X[1] - kReach)); y <= X[1] + kReach; ++y) {
        const int at = x + y * width;
        if (x >= 0 && x < width && y >= 0 && at < num_cameras)
          seen_by.push_back(&cameras[static_cast<std::size_t>(at)]);
      }
    }
    if (seen_by.size() < 2) continue;
    const VertexPointXYZ truth{X};
    const VertexHandle<VertexPointXYZ> point = graph.AddVertex(
        VertexPointXYZ{X + Vector3(uniform(-0.01, 0.01), uniform(-0.01, 0.01), 0.0)});
    for (const Camera* camera : seen_by) {
      EdgeBal edge;
      Vector2 r;
      if (!edge.Evaluate(camera->truth, truth, r, nullptr, nullptr)) continue;
      edge.uv = r + Vector2(uniform(-0.5, 0.5), uniform(-0.5, 0.5));
      static_cast<void>(graph.AddEdge(edge, {camera->handle, point}));
    }
  }
  return graph;
}

}  // namespace glissade::test
