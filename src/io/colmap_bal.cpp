// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/colmap_bal.h"

#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "glissade/base/out_of_memory.h"
#include "glissade/lie/so3.h"
#include "io/colmap_check.h"

namespace glissade {

namespace {

using internal::Index;

/// A camera that looks along z with y down, as COLMAP's do: BAL's after half a turn about x.
ColmapImage ImageOf(const VertexCameraBal& camera, std::uint32_t id) {
  const double* c = camera.data;
  const Quaternion q = so3::ExpQuaternion(Vector3(c[0], c[1], c[2]));
  ColmapImage image;
  image.id = image.camera = id;
  // i q, for the half turn i about x.
  const double wxyz[4] = {-q.x(), q.w(), -q.z(), q.y()};
  std::copy_n(wxyz, 4, image.q);
  image.t[0] = c[3];
  image.t[1] = -c[4];
  image.t[2] = -c[5];
  image.name = internal::Joined({"image_", std::to_string(id), ".jpg"});
  return image;
}

Result<ColmapModel> Convert(const BalProblem& bal) {
  const auto num_cameras = static_cast<std::int64_t>(bal.cameras.size());
  const auto num_points = static_cast<std::int64_t>(bal.points.size());
  if (bal.cameras.empty() || bal.points.empty() || bal.observations.empty())
    return Status(StatusCode::kInvalidArgument, "BAL problem: nothing is in it");
  double half_width = 1.0, half_height = 1.0;
  for (const BalObservation& o : bal.observations) {
    const double uv[2] = {o.u, o.v};
    const bool known =
        0 <= o.camera && o.camera < num_cameras && 0 <= o.point && o.point < num_points;
    if (!known || !internal::AllFinite(uv, 2) || std::abs(o.u) > 1e9 || std::abs(o.v) > 1e9) {
      return Status(StatusCode::kInvalidArgument,
                    internal::Joined({"BAL problem: observation ",
                                      std::to_string(&o - bal.observations.data()),
                                      " is of no camera or point, or has no place in an image"}));
    }
    half_width = std::max(half_width, std::ceil(std::abs(o.u)));
    half_height = std::max(half_height, std::ceil(std::abs(o.v)));
  }
  ColmapModel model;
  for (std::size_t k = 0; k < bal.cameras.size(); ++k) {
    const double* c = bal.cameras[k].data;
    const auto id = static_cast<std::uint32_t>(k + 1);
    model.cameras.push_back({id,
                             ColmapCameraModel::kRadial,
                             static_cast<std::uint64_t>(2.0 * half_width),
                             static_cast<std::uint64_t>(2.0 * half_height),
                             {c[6], half_width, half_height, c[7], c[8]}});
    model.images.push_back(ImageOf(bal.cameras[k], id));
  }
  for (std::size_t k = 0; k < bal.points.size(); ++k) {
    ColmapPoint point;
    point.id = static_cast<std::int64_t>(k + 1);
    std::copy_n(bal.points[k].data, 3, point.xyz);
    std::fill_n(point.rgb, 3, std::uint8_t{128});
    model.points.push_back(std::move(point));
  }
  for (const BalObservation& o : bal.observations) {
    ColmapImage& image = model.images[Index(o.camera)];
    model.points[Index(o.point)].track.push_back(
        {image.id, static_cast<std::uint32_t>(image.features.size())});
    image.features.push_back({o.u + half_width, half_height - o.v, std::int64_t{o.point} + 1});
  }
  if (Status status = CheckColmap(model); !status.ok()) return status;
  return model;
}

}  // namespace

Result<ColmapModel> ColmapFromBal(const BalProblem& bal) {
  return internal::OrOutOfMemory([&] { return Convert(bal); });
}

}  // namespace glissade
