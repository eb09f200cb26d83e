// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "glissade/glissade.h"

namespace glissade::test {

struct StripOptions {
  double scale = 1.0;                ///< of the world: units of length per metre
  Vector3 origin = Vector3::Zero();  ///< where the strip begins in the world
  double focal = 400.0;              ///< weights: 1 / (sigma of a bearing)
  double noise = 0.0;                ///< of measurements [pixels]
  double start_noise = 0.02;         ///< of poses [m]
  int num_frames = 5;
  int landmarks_per_frame = 20;
  Loss loss = {};
};

/// A camera that moves along x past points; the first two frames are fixed.
struct Strip {
  Problem problem;
  std::vector<VertexHandle<VertexPose>> frames;
  std::vector<VertexHandle<VertexInverseDepth>> depths;

  explicit Strip(const StripOptions& o = {}) {
    const auto truth = [&](int k) { return Vector3(0.3 * k, 0.05 * std::sin(k), 0.0); };
    for (int k = 0; k < o.num_frames; ++k) {
      Vector3 p = truth(k);
      if (k > 1) p += o.start_noise * Vector3(std::sin(7 * k), std::cos(5 * k), std::sin(3 * k));
      frames.push_back(problem.AddVertex(
          VertexPose{Pose(Quaternion::Identity(), Vector3(o.scale * p + o.origin))}));
    }
    (void)problem.SetFixed(frames[0]);
    (void)problem.SetFixed(frames[1]);
    EdgeOptions<EdgeReprojection> options;
    options.sqrt_information = Matrix2(o.focal * Matrix2::Identity());
    options.loss = o.loss;
    for (int h = 0; h + 1 < o.num_frames; ++h) {
      for (int l = 0; l < o.landmarks_per_frame; ++l) {
        const Vector2 uv(0.4 * std::sin(3 * l + h), 0.3 * std::cos(2 * l));
        const double depth = 4.0 + 2.0 * std::sin(l);
        depths.push_back(problem.AddVertex(VertexInverseDepth{1.1 / depth / o.scale}));
        for (int t = h + 1; t < o.num_frames; ++t) {
          const Vector3 d = Vector3(uv[0], uv[1], 1.0) * depth + truth(h) - truth(t);
          EdgeReprojection edge;
          edge.uv_host = uv;
          edge.uv_target = Vector2(d[0], d[1]) / d[2] +
                           o.noise / 400.0 * Vector2(std::sin(13 * l + t), std::cos(11 * l + h));
          (void)problem.AddEdge(edge,
                                {frames[static_cast<std::size_t>(h)],
                                 frames[static_cast<std::size_t>(t)], depths.back()},
                                options);
        }
      }
    }
  }
};

}  // namespace glissade::test
