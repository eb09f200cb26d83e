// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/random_states.h"
#include "glissade/io/colmap.h"

/// \file
/// A small reconstruction: images on an arc about a cloud of points.
namespace glissade::test {

/// Where a camera of COLMAP's sees a point, by the formulas of its documentation. Written apart
/// from the library's models.
inline Vector2 ProjectColmapByFormula(const ColmapCamera& camera, const Vector3& p) {
  const std::vector<double>& k = camera.parameters;
  const double x = p[0] / p[2], y = p[1] / p[2];
  const double n = x * x + y * y, r = std::sqrt(n);
  switch (camera.model) {
    case ColmapCameraModel::kSimplePinhole:
      return {k[0] * x + k[1], k[0] * y + k[2]};
    case ColmapCameraModel::kPinhole:
      return {k[0] * x + k[2], k[1] * y + k[3]};
    case ColmapCameraModel::kSimpleRadial:
      return {k[0] * x * (1 + k[3] * n) + k[1], k[0] * y * (1 + k[3] * n) + k[2]};
    case ColmapCameraModel::kRadial: {
      const double d = 1 + k[3] * n + k[4] * n * n;
      return {k[0] * x * d + k[1], k[0] * y * d + k[2]};
    }
    case ColmapCameraModel::kOpenCv: {
      const double d = k[4] * n + k[5] * n * n;
      const double dx = x * d + 2 * k[6] * x * y + k[7] * (n + 2 * x * x);
      const double dy = y * d + 2 * k[7] * x * y + k[6] * (n + 2 * y * y);
      return {k[0] * (x + dx) + k[2], k[1] * (y + dy) + k[3]};
    }
    case ColmapCameraModel::kOpenCvFisheye: {
      const double theta = std::atan(r), t2 = theta * theta;
      const double theta_d = theta * (1 + t2 * (k[4] + t2 * (k[5] + t2 * (k[6] + t2 * k[7]))));
      return {k[0] * theta_d / r * x + k[2], k[1] * theta_d / r * y + k[3]};
    }
    default:  // those that nothing solves for: somewhere in the image
      return {400 * x + 500, 400 * y + 400};
  }
}

/// Plausible parameters for 1000 x 800 pixels.
inline ColmapCamera MakeColmapCamera(std::uint32_t id, ColmapCameraModel model) {
  ColmapCamera camera{id, model, 1000, 800, {}};
  switch (model) {
    case ColmapCameraModel::kSimplePinhole:
      camera.parameters = {700, 500, 400};
      break;
    case ColmapCameraModel::kPinhole:
      camera.parameters = {700, 710, 500, 400};
      break;
    case ColmapCameraModel::kSimpleRadial:
      camera.parameters = {690, 500, 400, -0.05};
      break;
    case ColmapCameraModel::kRadial:
      camera.parameters = {680, 500, 400, -0.08, 0.02};
      break;
    case ColmapCameraModel::kOpenCv:
      camera.parameters = {705, 715, 510, 395, -0.1, 0.03, 0.001, -0.002};
      break;
    case ColmapCameraModel::kOpenCvFisheye:
      camera.parameters = {600, 605, 500, 400, 0.02, -0.01, 0.003, -0.001};
      break;
    default:
      camera.parameters.assign(static_cast<std::size_t>(ColmapNumParameters(model)), 0.25);
  }
  return camera;
}

struct ColmapSceneOptions {
  int images = 9;
  int points = 80;
  double noise = 0.3;  ///< px
  /// Cameras, which images take in turn.
  std::vector<ColmapCameraModel> cameras = {ColmapCameraModel::kSimpleRadial};
};

/// The truth, with features that have noise. Ids have gaps and do not increase.
inline ColmapModel MakeColmapScene(const ColmapSceneOptions& options, std::uint64_t seed) {
  Random random(seed);
  ColmapModel model;
  for (std::size_t k = 0; k < options.cameras.size(); ++k)
    model.cameras.push_back(
        MakeColmapCamera(static_cast<std::uint32_t>(100 - 3 * k), options.cameras[k]));
  for (int k = 0; k < options.images; ++k) {
    ColmapImage image;
    image.id = static_cast<std::uint32_t>(500 - 7 * k);
    image.camera = model.cameras[static_cast<std::size_t>(k) % model.cameras.size()].id;
    image.name = "image_" + std::to_string(k) + ".jpg";
    // The camera at 6 m from the middle, on an arc of 80 degrees, with a roll of its own.
    const double angle = 1.4 * (k / (options.images - 1.0) - 0.5);
    const Quaternion q_c_w = random.Rotation(0.05) * so3::ExpQuaternion(Vector3(0, angle, 0)) *
                             so3::ExpQuaternion(Vector3(0.1 * std::sin(3.0 * k), 0, 0));
    const double wxyz[4] = {q_c_w.w(), q_c_w.x(), q_c_w.y(), q_c_w.z()};
    std::copy_n(wxyz, 4, image.q);
    const Vector3 t = Vector3(0, 0, 6) + random.Vec3(0.3);
    std::copy_n(t.data(), 3, image.t);
    model.images.push_back(image);
  }
  for (int p = 0; p < options.points; ++p) {
    ColmapPoint point;
    point.id = 1000 + 11 * ((p * 37) % options.points);
    const Vector3 x = random.Vec3(1.8);
    std::copy_n(x.data(), 3, point.xyz);
    for (std::uint8_t& channel : point.rgb)
      channel = static_cast<std::uint8_t>(random.Uniform(0, 256));
    for (std::size_t k = 0; k < model.images.size(); ++k) {
      if (random.Uniform(0, 1) < 0.25) continue;
      ColmapImage& image = model.images[k];
      const Quaternion q(image.q[0], image.q[1], image.q[2], image.q[3]);
      const Vector3 p_c = q * x + Vector3(image.t);
      const Vector2 uv = ProjectColmapByFormula(model.cameras[k % model.cameras.size()], p_c) +
                         random.Vec2(1.7 * options.noise);
      // Features of no point in between.
      if (random.Uniform(0, 1) < 0.3)
        image.features.push_back({random.Uniform(0, 1000), random.Uniform(0, 800), -1});
      point.track.push_back({image.id, static_cast<std::uint32_t>(image.features.size())});
      image.features.push_back({uv[0], uv[1], point.id});
    }
    if (point.track.empty()) continue;
    model.points.push_back(point);
  }
  return model;
}

/// Away from the truth: a start for a solve.
inline ColmapModel PerturbColmapScene(ColmapModel model, std::uint64_t seed) {
  Random random(seed);
  for (ColmapImage& image : model.images) {
    const Quaternion q =
        random.Rotation(0.01) * Quaternion(image.q[0], image.q[1], image.q[2], image.q[3]);
    const double wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
    std::copy_n(wxyz, 4, image.q);
    for (double& t : image.t)
      t += random.Uniform(-0.05, 0.05);
  }
  for (ColmapPoint& point : model.points) {
    for (double& x : point.xyz)
      x += random.Uniform(-0.05, 0.05);
  }
  for (ColmapCamera& camera : model.cameras) {
    const bool two = camera.parameters.size() != 3 && camera.parameters.size() != 5 &&
                     camera.model != ColmapCameraModel::kSimpleRadial;
    const std::size_t focal = two ? 2 : 1;
    for (std::size_t k = 0; k < camera.parameters.size(); ++k) {
      if (k < focal) camera.parameters[k] *= 1.02;
      if (k >= focal + 2) camera.parameters[k] *= 0.5;
    }
  }
  return model;
}

}  // namespace glissade::test
