// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/renderer.h"

#include <algorithm>
#include <cmath>

namespace glissade::app {

namespace {

constexpr int kTilePx = 16;

/// A face of the scene as one number: those of the room come first.
int FaceOf(const Hit& hit) {
  return 6 * (hit.box - Hit::kRoom) + hit.face;
}
/// The box that it is of, or Hit::kRoom.
int BoxOfFace(int face) {
  return face / 6 + Hit::kRoom;
}
constexpr int kNone = -1;

/// The boxes that rays within an angle of an axis from o can meet, by the spheres around them.
void CandidatesOf(const Scene& scene, const Vector3& o, const Vector3& axis, double sine,
                  double cosine, std::vector<int>* candidates) {
  candidates->clear();
  for (std::size_t b = 0; b < scene.boxes.size(); ++b) {
    const Box& box = scene.boxes[b];
    Vector3 way;
    double radius2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      way[k] = 0.5 * (box.low[k] + box.high[k]) - o[k];
      radius2 += 0.25 * (box.high[k] - box.low[k]) * (box.high[k] - box.low[k]);
    }
    const double distance2 = way.squaredNorm();
    bool seen = distance2 <= radius2;
    if (!seen) {
      // cos(angle of the tile + angle of the sphere)
      const double s = std::sqrt(radius2 / distance2), c = std::sqrt(1.0 - s * s);
      seen = way.dot(axis) >= (cosine * c - sine * s) * std::sqrt(distance2);
    }
    if (seen) candidates->push_back(static_cast<int>(b));
  }
}

/// What the eye gets from a hit: the mean over the pixel's footprint on the face, an ellipse that
/// is `width` across and longer by 1 / cosine in the direction that the ray is inclined to. Several
/// samples along it, each as wide as it is across, see details that one as wide as long would blur.
float Shade(const Scene& scene, const Hit& hit, const float o[3], const float d[3], float width,
            float length) {
  const Box& box = scene.BoxOf(hit);
  const Face& face = box.faces[static_cast<std::size_t>(hit.face)];
  const int normal = hit.face / 2, a = normal == 0 ? 1 : 0, b = normal == 2 ? 1 : 2;
  const float u = o[a] + hit.t * d[a] - box.low[a] + face.u_m;
  const float v = o[b] + hit.t * d[b] - box.low[b] + face.v_m;
  const Texture& texture = scene.textures[static_cast<std::size_t>(face.texture)];
  constexpr float kMost = 6.0f;
  const float stretch = length / std::max(std::abs(d[normal]), 1e-6f);
  if (stretch < 1.5f) return face.shade * texture.At(u, v, width);
  const float samples = std::min(static_cast<float>(static_cast<int>(stretch + 0.5f)), kMost);
  const float across = width * std::max(1.0f, stretch / kMost);
  const float slope = std::sqrt(d[a] * d[a] + d[b] * d[b]);
  const float step = width * stretch / (samples * slope);
  float sum = 0.0f;
  for (float k = 0.5f * (1.0f - samples); k < 0.5f * samples; k += 1.0f)
    sum += texture.At(u + k * step * d[a], v + k * step * d[b], across);
  return face.shade * sum / samples;
}

}  // namespace

Renderer::Renderer(const vision::Camera& camera)
    : width_(camera.width), height_(camera.height), focal_(camera.pinhole().fx) {
  MakeRays(camera);
  MakeTiles();
}

void Renderer::MakeRays(const vision::Camera& camera) {
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  rays_.resize(pixels);
  std::vector<char> has_ray(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const double uv[2] = {static_cast<double>(i % static_cast<std::size_t>(width_)),
                          static_cast<double>(i / static_cast<std::size_t>(width_))};
    double xy[2];
    if (!camera.Undistort(uv, xy)) continue;
    has_ray[i] = 1;
    rays_[i].x = static_cast<float>(xy[0]);
    rays_[i].y = static_cast<float>(xy[1]);
    rays_[i].length = static_cast<float>(std::sqrt(xy[0] * xy[0] + xy[1] * xy[1] + 1.0));
  }
  // The width is the larger one of the angles to the neighbours beside and below.
  const auto angle = [&](std::size_t i, std::size_t j) {
    const Ray &a = rays_[i], &b = rays_[j];
    const Eigen::Vector3f da(a.x, a.y, 1.0f), db(b.x, b.y, 1.0f);
    return (da / a.length - db / b.length).norm();
  };
  const auto stride = static_cast<std::size_t>(width_);
  for (std::size_t i = 0; i < pixels; ++i) {
    if (has_ray[i] == 0) continue;
    float widest = 0.0f;
    if ((i + 1) % stride != 0 && has_ray[i + 1] != 0) widest = angle(i, i + 1);
    if (i + stride < pixels && has_ray[i + stride] != 0) {
      widest = std::max(widest, angle(i, i + stride));
    }
    if (widest == 0.0f) widest = static_cast<float>(1.0 / focal_);
    rays_[i].width = widest * rays_[i].length;
  }
}

void Renderer::MakeTiles() {
  for (int y = 0; y < height_; y += kTilePx) {
    for (int x = 0; x < width_; x += kTilePx) {
      Tile tile;
      tile.x = x;
      tile.y = y;
      tile.width = std::min(kTilePx, width_ - x);
      tile.height = std::min(kTilePx, height_ - y);
      std::vector<Vector3> directions;
      Vector3 sum = Vector3::Zero();
      for (int i = y; i < y + tile.height; ++i) {
        for (int j = x; j < x + tile.width; ++j) {
          const Ray& ray = rays_[IndexOf(j, i)];
          if (ray.width > 0.0f) {
            sum += directions.emplace_back(Vector3(ray.x, ray.y, 1.0).normalized());
          }
        }
      }
      if (directions.empty()) continue;
      tile.axis = sum.normalized();
      tile.cosine = 1.0;
      for (const Vector3& direction : directions)
        tile.cosine = std::min(tile.cosine, tile.axis.dot(direction));
      tile.sine = std::sqrt(1.0 - tile.cosine * tile.cosine);
      tiles_.push_back(tile);
    }
  }
}

/// A camera's place, in floats.
struct Renderer::View {
  float R[9];  // R_s_c, row by row
  float o[3];

  explicit View(const Pose& T_s_c) {
    const Matrix3 rotation = T_s_c.R();
    for (int i = 0; i < 9; ++i)
      R[i] = static_cast<float>(rotation(i / 3, i % 3));
    for (int i = 0; i < 3; ++i)
      o[i] = static_cast<float>(T_s_c.p()[i]);
  }
  void Turn(const Ray& ray, float d[3]) const {
    for (int i = 0; i < 3; ++i)
      d[i] = R[3 * i] * ray.x + R[3 * i + 1] * ray.y + R[3 * i + 2];
  }
};

void Renderer::Render(const Scene& scene, const Pose& T_s_c, std::vector<float>* image) {
  image->assign(rays_.size(), 0.0f);
  faces_.assign(rays_.size(), kNone);
  const View view(T_s_c);
  std::vector<int> candidates;
  for (const Tile& tile : tiles_) {
    CandidatesOf(scene, T_s_c.p(), T_s_c.R() * tile.axis, tile.sine, tile.cosine, &candidates);
    for (int y = tile.y; y < tile.y + tile.height; ++y) {
      std::size_t i = IndexOf(tile.x, y);
      for (const std::size_t end = i + static_cast<std::size_t>(tile.width); i < end; ++i) {
        const Ray& ray = rays_[i];
        if (!(ray.width > 0.0f)) continue;
        float d[3];
        view.Turn(ray, d);
        const Hit hit = scene.Cast(view.o, d, candidates);
        faces_[i] = FaceOf(hit);
        (*image)[i] = Shade(scene, hit, view.o, d, hit.t * ray.width, ray.length);
      }
    }
  }
  SmoothEdges(scene, view, image);
}

/// A pixel beside which another face begins is the mean of four rays through it, which meet what it
/// and its neighbours see: edges have no steps that a tracker would take for corners.
void Renderer::SmoothEdges(const Scene& scene, const View& view, std::vector<float>* image) const {
  std::vector<int> candidates;
  for (int y = 1; y + 1 < height_; ++y) {
    for (int x = 1; x + 1 < width_; ++x) {
      const std::size_t i = IndexOf(x, y);
      const std::size_t beside[4] = {i - 1, i + 1, IndexOf(x, y - 1), IndexOf(x, y + 1)};
      const int face = faces_[i];
      bool is_edge = false, has_rays = face != kNone;
      for (const std::size_t j : beside) {
        is_edge = is_edge || faces_[j] != face;
        has_rays = has_rays && faces_[j] != kNone;
      }
      if (!is_edge || !has_rays) continue;
      candidates.clear();
      for (const std::size_t j : {i, beside[0], beside[1], beside[2], beside[3]}) {
        const int box = BoxOfFace(faces_[j]);
        if (box != Hit::kRoom &&
            std::find(candidates.begin(), candidates.end(), box) == candidates.end()) {
          candidates.push_back(box);
        }
      }
      float sum = 0.0f;
      for (int k = 0; k < 4; ++k) {
        // A quarter of a pixel aside and up or down.
        const float right = k % 2 == 0 ? -0.125f : 0.125f, down = k / 2 == 0 ? -0.125f : 0.125f;
        const auto moved = [&](float Ray::*c) {
          return rays_[i].*c + right * (rays_[beside[1]].*c - rays_[beside[0]].*c) +
                 down * (rays_[beside[3]].*c - rays_[beside[2]].*c);
        };
        Ray ray = rays_[i];
        ray.x = moved(&Ray::x);
        ray.y = moved(&Ray::y);
        float d[3];
        view.Turn(ray, d);
        const Hit hit = scene.Cast(view.o, d, candidates);
        sum += Shade(scene, hit, view.o, d, hit.t * ray.width, ray.length);
      }
      (*image)[i] = 0.25f * sum;
    }
  }
}

void Renderer::RenderMoving(const Scene& scene, std::span<const Pose> T_s_c,
                            std::vector<float>* image) {
  Render(scene, T_s_c[0], image);
  if (T_s_c.size() == 1) return;
  for (const Pose& pose : T_s_c.subspan(1)) {
    Render(scene, pose, &one_);
    for (std::size_t i = 0; i < one_.size(); ++i)
      (*image)[i] += one_[i];
  }
  const float part = 1.0f / static_cast<float>(T_s_c.size());
  for (float& grey : *image)
    grey *= part;
}

double Renderer::MotionBetween(const Scene& scene, const Pose& from, const Pose& to) const {
  const Pose T_to_s = to.Inverse();
  double most = 0.0;
  for (int k = 0; k < 9; ++k) {
    const Ray& ray = rays_[IndexOf((k % 3) * (width_ - 1) / 2, (k / 3) * (height_ - 1) / 2)];
    if (!(ray.width > 0.0f)) continue;
    const Vector3 ray_c(ray.x, ray.y, 1.0);
    const Vector3 ray_s = from.R() * ray_c;
    float o[3], d[3];
    for (int i = 0; i < 3; ++i) {
      o[i] = static_cast<float>(from.p()[i]);
      d[i] = static_cast<float>(ray_s[i]);
    }
    const double t = scene.Cast(o, d).t;
    const Vector3 seen = T_to_s * Vector3(from.p() + t * ray_s);
    // Between the directions, in pixels that are as wide as this one.
    const double cosine = seen.normalized().dot(ray_c.normalized());
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    most = std::max(most, angle * ray.length / ray.width);
  }
  return std::min(most, static_cast<double>(width_));
}

}  // namespace glissade::app
