// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/scene.h"

#include <algorithm>

#include "glissade/sim/noise_source.h"

namespace glissade::app {

namespace {

constexpr std::uint64_t kSceneStream = 302;

void Paint(const Scene& scene, sim::NoiseSource* random, Box* box) {
  // No two walls alike.
  constexpr float kShade[6] = {0.95f, 0.75f, 1.05f, 0.85f, 1.0f, 0.9f};
  for (std::size_t f = 0; f < box->faces.size(); ++f) {
    Face& face = box->faces[f];
    face.texture = static_cast<int>(random->Next() % scene.textures.size());
    const double period = scene.textures[static_cast<std::size_t>(face.texture)].period_m();
    // At least one period: what is a rounding error outside of the face is still positive.
    face.u_m = static_cast<float>(random->Uniform(1.0, 2.0) * period);
    face.v_m = static_cast<float>(random->Uniform(1.0, 2.0) * period);
    face.shade = kShade[f] * static_cast<float>(random->Uniform(0.9, 1.1));
  }
}

/// Whether a box, this much larger on all sides, holds none of the positions.
bool IsClear(const Box& box, std::span<const Vector3> positions, double clearance) {
  const auto margin = static_cast<float>(clearance);
  return std::none_of(positions.begin(), positions.end(), [&](const Vector3& p) {
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      const auto x = static_cast<float>(p[k]);
      inside = inside && x > box.low[k] - margin && x < box.high[k] + margin;
    }
    return inside;
  });
}

bool Overlap(const Box& a, const Box& b) {
  constexpr float kGap = 0.05f;
  return a.low[0] < b.high[0] + kGap && b.low[0] < a.high[0] + kGap &&
         a.low[1] < b.high[1] + kGap && b.low[1] < a.high[1] + kGap;
}

/// On the floor, anywhere in the room; every third one a pillar.
Box DrawBox(const Box& room, sim::NoiseSource* random) {
  const bool pillar = random->Uniform(0.0, 1.0) < 0.34;
  const double height = pillar ? 1e3 : random->Uniform(0.4, 2.0);
  Box box;
  for (int k = 0; k < 2; ++k) {
    const double room_size = room.high[k] - room.low[k];
    const double size =
        std::min(pillar ? random->Uniform(0.3, 0.6) : random->Uniform(0.5, 1.6), 0.3 * room_size);
    const double low = random->Uniform(room.low[k], room.high[k] - size);
    box.low[k] = static_cast<float>(low);
    box.high[k] = static_cast<float>(low + size);
  }
  box.low[2] = room.low[2];
  box.high[2] = std::min(room.low[2] + static_cast<float>(height), room.high[2]);
  return box;
}

int UsualBoxes(const Box& room) {
  const float area = (room.high[0] - room.low[0]) * (room.high[1] - room.low[1]);
  return std::clamp(static_cast<int>(area / 12.0f), 6, 100);
}

/// The smallest rotation that makes "up" z.
Matrix3 Levelling(const Vector3& gravity) {
  const Eigen::Vector3d up = -gravity.normalized();
  return Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace

Hit Scene::Cast(const float o[3], const float d[3]) const {
  Hit hit = Cast(o, d, {});
  for (std::size_t k = 0; k < boxes.size(); ++k)
    if (MeetsBox(boxes[k], o, d, &hit.t, &hit.face)) hit.box = static_cast<int>(k);
  return hit;
}

Pose Scene::ToScene(const Pose& T_w_c) const {
  return Pose(R_s_w, Vector3::Zero()) * T_w_c;
}

Result<Scene> MakeScene(std::span<const Vector3> positions, const Vector3& gravity,
                        const SceneOptions& options, std::vector<Texture> textures) {
  if (positions.empty() || !(gravity.norm() > 0.0) || !gravity.allFinite()) {
    return Status(StatusCode::kInvalidArgument, "a room needs a flight and a gravity");
  }
  Scene scene;
  scene.R_s_w = Levelling(gravity);
  scene.textures = std::move(textures);
  if (scene.textures.empty()) scene.textures.push_back(Texture::Random(options.seed));
  std::vector<Vector3> path;
  Vector3 low = scene.R_s_w * positions[0], high = low;
  for (const Vector3& p_w : positions) {
    const Vector3& p = path.emplace_back(scene.R_s_w * p_w);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vector3 margin(options.wall_m, options.wall_m, options.floor_m);
  for (int k = 0; k < 3; ++k) {
    scene.room.low[k] = static_cast<float>(low[k] - margin[k]);
    scene.room.high[k] = static_cast<float>(high[k] + margin[k]);
  }
  sim::NoiseSource random(options.seed, kSceneStream);
  Paint(scene, &random, &scene.room);
  const int asked = options.boxes >= 0 ? options.boxes : UsualBoxes(scene.room);
  for (int tries = 0; tries < 100 * asked; ++tries) {
    if (static_cast<int>(scene.boxes.size()) == asked) break;
    Box box = DrawBox(scene.room, &random);
    const bool free = std::none_of(scene.boxes.begin(), scene.boxes.end(),
                                   [&](const Box& other) { return Overlap(box, other); });
    if (!free || !IsClear(box, path, options.clearance_m)) continue;
    Paint(scene, &random, &box);
    scene.boxes.push_back(box);
  }
  return scene;
}

}  // namespace glissade::app
