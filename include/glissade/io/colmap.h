// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "glissade/base/status.h"

/// \file
/// COLMAP's sparse models: a folder with cameras, images and points3D, as text (.txt) or binary
/// (.bin). The format is described at colmap.github.io/format.html.
///
/// Images are in pixels, with (0, 0) the upper left corner of the upper left pixel; cameras look
/// along z, x to the right, y down. rigs and frames, which COLMAP 3.12 and later write as well, are
/// neither read nor written nor removed.
namespace glissade {

/// Numbered as in binary files.
enum class ColmapCameraModel : std::int32_t {
  kSimplePinhole = 0,        ///< f, cx, cy
  kPinhole = 1,              ///< fx, fy, cx, cy
  kSimpleRadial = 2,         ///< f, cx, cy, k
  kRadial = 3,               ///< f, cx, cy, k1, k2
  kOpenCv = 4,               ///< fx, fy, cx, cy, k1, k2, p1, p2
  kOpenCvFisheye = 5,        ///< fx, fy, cx, cy, k1, k2, k3, k4
  kFullOpenCv = 6,           ///< fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6
  kFov = 7,                  ///< fx, fy, cx, cy, omega
  kSimpleRadialFisheye = 8,  ///< f, cx, cy, k
  kRadialFisheye = 9,        ///< f, cx, cy, k1, k2
  kThinPrismFisheye = 10,    ///< fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, sx1, sy1
};
inline constexpr int kNumColmapCameraModels = 11;

/// "SIMPLE_PINHOLE", as in text files; "unknown" for what is none of them.
[[nodiscard]] std::string_view ColmapModelName(ColmapCameraModel model);
/// Of its parameters; 0 for what is none of them.
[[nodiscard]] int ColmapNumParameters(ColmapCameraModel model);

struct ColmapCamera {
  std::uint32_t id = 0;
  ColmapCameraModel model = ColmapCameraModel::kSimplePinhole;
  std::uint64_t width = 0;   ///< px
  std::uint64_t height = 0;  ///< px
  std::vector<double> parameters;

  friend bool operator==(const ColmapCamera&, const ColmapCamera&) = default;
};

/// A feature in an image.
struct ColmapFeature {
  double x = 0.0, y = 0.0;  ///< px
  std::int64_t point = -1;  ///< id of the 3-D point, -1: none

  friend bool operator==(const ColmapFeature&, const ColmapFeature&) = default;
};

struct ColmapImage {
  std::uint32_t id = 0;
  double q[4] = {1.0, 0.0, 0.0, 0.0};  ///< w x y z; X_camera = R(q) X_world + t
  double t[3] = {};
  std::uint32_t camera = 0;  ///< id
  std::string name;
  std::vector<ColmapFeature> features;

  friend bool operator==(const ColmapImage&, const ColmapImage&) = default;
};

struct ColmapTrackElement {
  std::uint32_t image = 0;    ///< id
  std::uint32_t feature = 0;  ///< index in the image's features

  friend bool operator==(const ColmapTrackElement&, const ColmapTrackElement&) = default;
};

struct ColmapPoint {
  std::int64_t id = 0;
  double xyz[3] = {};  ///< world
  std::uint8_t rgb[3] = {};
  double error = -1.0;  ///< mean distance between its features and where it projects to, px
  std::vector<ColmapTrackElement> track;

  friend bool operator==(const ColmapPoint&, const ColmapPoint&) = default;
};

/// The content of a model, in its order. Ids are of 32 bits for cameras and images, 0 to 2^63 - 1
/// for points.
struct ColmapModel {
  std::vector<ColmapCamera> cameras;
  std::vector<ColmapImage> images;
  std::vector<ColmapPoint> points;

  friend bool operator==(const ColmapModel&, const ColmapModel&) = default;
};

enum class ColmapFormat : std::uint8_t { kBinary, kText };

/// Which files a folder has. Of both, binary, as COLMAP has it; kIoError if it has neither.
[[nodiscard]] Result<ColmapFormat> FindColmapFormat(const std::string& folder);

/// Reads the model in a folder. All or nothing: on failure a status whose message is "file:line:
/// what was expected, what was found", or "file:byte N: ..." where it is binary (kIoError where a
/// file cannot be opened, else kParseError). All numbers are finite, all quaternions can be made
/// unit, ids are unique, those that are named exist, and tracks and features name each other.
[[nodiscard]] Result<ColmapModel> ReadColmap(const std::string& folder);

/// Writes a model, into a folder that is made if need be: reading it gives the same bits. Refuses
/// what ReadColmap would not take back, then nothing is written: also text into a folder that has a
/// binary model, and in text a name that is not one word or begins with '#'. Each file appears
/// whole or not at all.
Status WriteColmap(const ColmapModel& model, const std::string& folder,
                   ColmapFormat format = ColmapFormat::kBinary);

/// What ReadColmap and WriteColmap ask of a model.
[[nodiscard]] Status CheckColmap(const ColmapModel& model);

}  // namespace glissade
