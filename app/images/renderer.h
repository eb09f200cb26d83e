// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "glissade/lie/pose.h"
#include "glissade/vision/camera.h"
#include "images/scene.h"

namespace glissade::app {

/// What a camera sees of a scene: one ray through each pixel's centre, and what it meets, averaged
/// over the pixel's width there.
class Renderer {
 public:
  /// The camera must be valid.
  explicit Renderer(const vision::Camera& camera);

  /// Grey values, row by row, not rounded; 0 where a pixel has no ray. The camera must be inside of
  /// the room and outside of the boxes.
  void Render(const Scene& scene, const Pose& T_s_c, std::vector<float>* image);
  /// The mean of images from several poses, at least one: what a camera sees that moves while its
  /// shutter is open.
  void RenderMoving(const Scene& scene, std::span<const Pose> T_s_c, std::vector<float>* image);
  /// How far the picture moves between two poses, at the most of nine pixels all over the image
  /// (px); turns so large that a point leaves the image's front count as the image's width.
  [[nodiscard]] double MotionBetween(const Scene& scene, const Pose& from, const Pose& to) const;

 private:
  /// Through a pixel's centre.
  struct Ray {
    float x = 0.0f, y = 0.0f;  ///< direction (x, y, 1)
    float length = 1.0f;       ///< of that
    float width = 0.0f;        ///< of the pixel at z = 1, across the ray; 0: the pixel has no ray
  };
  /// Pixels that look in about the same direction: boxes that none of them can see are left out.
  struct Tile {
    int x = 0, y = 0, width = 0, height = 0;
    Vector3 axis;         ///< unit vector
    double sine, cosine;  ///< of the angle that all its rays are within
  };

  struct View;

  [[nodiscard]] std::size_t IndexOf(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  void MakeRays(const vision::Camera& camera);
  void MakeTiles();
  void SmoothEdges(const Scene& scene, const View& view, std::vector<float>* image) const;

  int width_, height_;
  double focal_;
  std::vector<Ray> rays_;
  std::vector<Tile> tiles_;
  std::vector<int> faces_;  // that each pixel sees, see FaceOf; kNone: it has no ray
  std::vector<float> one_;  // image of a moving camera
};

}  // namespace glissade::app
