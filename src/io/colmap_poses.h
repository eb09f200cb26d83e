// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <unordered_map>

#include "glissade/io/colmap.h"
#include "glissade/lie/pose.h"

namespace glissade::internal {

/// T_W_C of an image, which has T_C_W.
inline Pose CameraInWorld(const ColmapImage& image) {
  Quaternion q(image.q[0], image.q[1], image.q[2], image.q[3]);
  q.normalize();
  return Pose(q, Vector3(image.t[0], image.t[1], image.t[2])).Inverse();
}

/// Index of images and cameras by id.
struct ColmapIds {
  std::unordered_map<std::uint32_t, std::size_t> image, camera;

  explicit ColmapIds(const ColmapModel& model) {
    for (std::size_t k = 0; k < model.images.size(); ++k)
      image.emplace(model.images[k].id, k);
    for (std::size_t k = 0; k < model.cameras.size(); ++k)
      camera.emplace(model.cameras[k].id, k);
  }
};

}  // namespace glissade::internal
