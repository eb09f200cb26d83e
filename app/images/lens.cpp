// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/lens.h"

#include <variant>

namespace glissade::app {

namespace {

CameraPinhole Resized(CameraPinhole pinhole, const vision::Camera& from, int width, int height) {
  const double scale = static_cast<double>(width) / from.width;
  // Pixel centres are at whole numbers, so that the middle of an image is (width - 1) / 2.
  pinhole.cx = scale * (pinhole.cx - 0.5 * (from.width - 1)) + 0.5 * (width - 1);
  pinhole.cy = scale * (pinhole.cy - 0.5 * (from.height - 1)) + 0.5 * (height - 1);
  pinhole.fx *= scale;
  pinhole.fy *= scale;
  return pinhole;
}

/// Published with the data sets: Burri et al., IJRR 2016; Schubert et al., IROS 2018.
CameraRadtan EurocLens(const CameraPinhole& pinhole, int index) {
  if (index == 0) return {pinhole, -0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0};
  return {pinhole, -0.28368365, 0.07451284, -0.00010473, -3.55590700e-05, 0.0};
}

CameraKannalaBrandt TumViLens(const CameraPinhole& pinhole, int index) {
  if (index == 0) {
    return {pinhole, 0.0034823894022493434, 0.0007150348452162257, -0.0020532361418706202,
            0.00020293673591811182};
  }
  return {pinhole, 0.0034003170790442797, 0.001766278153469831, -0.00266312569781606,
          0.0003299517423931039};
}

}  // namespace

const std::vector<std::string>& LensModels() {
  static const std::vector<std::string> models = {"own", "none", "radtan", "equidistant"};
  return models;
}

vision::Camera WithLens(const vision::Camera& camera, int index, const LensOptions& options) {
  vision::Camera out = camera;
  if (options.width > 0) {
    out.width = options.width;
    out.height = options.height;
  }
  CameraPinhole pinhole = Resized(camera.pinhole(), camera, out.width, out.height);
  if (options.focal_px > 0.0) pinhole.fx = pinhole.fy = options.focal_px;
  if (options.model == "none") {
    out.lens = pinhole;
  } else if (options.model == "radtan") {
    out.lens = EurocLens(pinhole, index);
  } else if (options.model == "equidistant") {
    out.lens = TumViLens(pinhole, index);
  } else {
    std::visit(
        [&](auto& lens) {
          if constexpr (std::is_same_v<std::decay_t<decltype(lens)>, CameraPinhole>) {
            lens = pinhole;
          } else {
            lens.pinhole = pinhole;
          }
        },
        out.lens);
  }
  return out;
}

}  // namespace glissade::app
