// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/lie/pose.h"
#include "images/texture.h"

/// \file
/// A closed room around a flight with boxes in it. Its frame S has the world's origin, and its z is
/// up: R_s_w is the identity where the world's is, too.
namespace glissade::app {

/// How a face of a box is painted.
struct Face {
  int texture = 0;               ///< index in the scene's textures
  float u_m = 0.0f, v_m = 0.0f;  ///< of the texture, at the face's lower corner
  float shade = 1.0f;            ///< grey values are multiplied by this
};

/// Along the axes of S. Faces 2k and 2k + 1 are those at low[k] and high[k].
struct Box {
  float low[3] = {}, high[3] = {};
  std::array<Face, 6> faces;
};

/// Where a ray meets something first: at o + t d.
struct Hit {
  float t = 0.0f;
  int box = kRoom;  ///< index in the scene's boxes
  int face = 0;
  static constexpr int kRoom = -1;
};

struct SceneOptions {
  double wall_m = 3.0;       ///< from the box around the flight to the walls
  double floor_m = 1.5;      ///< to floor and ceiling
  int boxes = -1;            ///< asked for; -1: one for each 12 m^2 of the floor, at least 6
  double clearance_m = 0.7;  ///< from the flight to a box
  std::uint64_t seed = 1;
};

struct Scene {
  Matrix3 R_s_w = Matrix3::Identity();
  Box room;
  std::vector<Box> boxes;
  std::vector<Texture> textures;

  /// From a point inside of the room, outside of the boxes, along d, which need not be of unit
  /// length; of the boxes only those at `candidates` (indices).
  [[nodiscard]] Hit Cast(const float o[3], const float d[3],
                         std::span<const int> candidates) const {
    float nearest = kFar;
    int in_box = Hit::kRoom, face = 0;
    for (int k = 0; k < 3; ++k) {
      const int side = d[k] > 0.0f ? 1 : 0;
      const float t = ((side == 1 ? room.high[k] : room.low[k]) - o[k]) / d[k];
      if (t > 0.0f && t < nearest) {
        nearest = t;
        face = 2 * k + side;
      }
    }
    for (const int index : candidates)
      if (MeetsBox(boxes[static_cast<std::size_t>(index)], o, d, &nearest, &face)) in_box = index;
    return {nearest, in_box, face};
  }
  /// The same, of all boxes.
  [[nodiscard]] Hit Cast(const float o[3], const float d[3]) const;
  [[nodiscard]] const Box& BoxOf(const Hit& hit) const {
    return hit.box == Hit::kRoom ? room : boxes[static_cast<std::size_t>(hit.box)];
  }
  /// T_s_c of T_w_c.
  [[nodiscard]] Pose ToScene(const Pose& T_w_c) const;

 private:
  static constexpr float kFar = 1e30f;

  /// The slabs of Kay and Kajiya (SIGGRAPH 1986): the last entry comes before the first exit. A
  /// direction along a slab gives infinite numbers of the right sign. True, and nearest and face of
  /// the box, where that is nearer.
  static bool MeetsBox(const Box& box, const float o[3], const float d[3], float* nearest,
                       int* face) {
    float enter = 0.0f, leave = *nearest;
    int at = -1;
    for (int k = 0; k < 3; ++k) {
      const float inverse = 1.0f / d[k];
      const float a = (box.low[k] - o[k]) * inverse, b = (box.high[k] - o[k]) * inverse;
      const float first = a < b ? a : b, last = a < b ? b : a;
      if (first > enter) {
        enter = first;
        at = 2 * k + (d[k] > 0.0f ? 0 : 1);
      }
      if (last < leave) leave = last;
    }
    if (at < 0 || !(enter < leave)) return false;
    *nearest = enter;
    *face = at;
    return true;
  }
};

/// A room around the positions (W) that leaves them free, with boxes on the floor, up to the
/// ceiling some of them, as many of those asked for as find a place. gravity (m/s^2, W) says what
/// is up. Without textures: one is made of the seed. kInvalidArgument: no positions, no gravity.
[[nodiscard]] Result<Scene> MakeScene(std::span<const Vector3> positions, const Vector3& gravity,
                                      const SceneOptions& options, std::vector<Texture> textures);

}  // namespace glissade::app
