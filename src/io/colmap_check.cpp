// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/colmap_check.h"

#include "glissade/base/validate.h"

namespace glissade::internal {

std::string Joined(std::initializer_list<std::string_view> pieces) {
  std::string text;
  for (const std::string_view piece : pieces)
    text.append(piece);
  return text;
}

std::string ColmapCheck::Camera(std::size_t k) {
  const ColmapCamera& camera = model_.cameras[k];
  const std::string id = std::to_string(camera.id);
  const int count = ColmapNumParameters(camera.model);
  if (camera.id == kNoColmapId) return Joined({"id ", id, " means no camera"});
  if (count == 0) return Joined({"camera ", id, " has an unknown model"});
  if (static_cast<int>(camera.parameters.size()) != count) {
    return Joined({"camera ", id, " has ", std::to_string(camera.parameters.size()),
                   " parameters, ", ColmapModelName(camera.model), " has ", std::to_string(count)});
  }
  if (!AllFinite(camera.parameters.data(), count))
    return Joined({"a parameter of camera ", id, " is not finite"});
  constexpr auto kMostSize = static_cast<std::uint64_t>(kMostColmapPoint);
  if (camera.width > kMostSize || camera.height > kMostSize)
    return Joined({"the size of camera ", id, " is above 2^63 - 1"});
  if (!cameras_.insert(camera.id).second) return Joined({"a second camera ", id});
  return {};
}

std::string ColmapCheck::Image(std::size_t k) {
  const ColmapImage& image = model_.images[k];
  const std::string id = std::to_string(image.id);
  if (image.id == kNoColmapId) return Joined({"id ", id, " means no image"});
  if (!AllFinite(image.q, 4) || !AllFinite(image.t, 3))
    return Joined({"the pose of image ", id, " is not finite"});
  const double* q = image.q;
  const double norm2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(norm2 > 1e-12 && norm2 < 1e12))
    return Joined({"the quaternion of image ", id, " cannot be made unit"});
  if (!cameras_.contains(image.camera)) {
    return Joined(
        {"image ", id, " is by camera ", std::to_string(image.camera), ", which there is not"});
  }
  if (image.name.find('\0') != std::string::npos)
    return Joined({"the name of image ", id, " has a character 0"});
  for (std::size_t f = 0; f < image.features.size(); ++f) {
    const ColmapFeature& feature = image.features[f];
    const double uv[2] = {feature.x, feature.y};
    if (AllFinite(uv, 2) && feature.point >= -1) continue;
    return Joined({"feature ", std::to_string(f), " of image ", id,
                   feature.point < -1 ? " names a point below -1" : " is not finite"});
  }
  if (!images_.emplace(image.id, k).second) return Joined({"a second image ", id});
  in_track_.emplace_back(image.features.size(), false);
  return {};
}

std::string ColmapCheck::Point(std::size_t k) {
  const ColmapPoint& point = model_.points[k];
  const std::string id = std::to_string(point.id);
  if (point.id < 0) return Joined({"id ", id, " means no point"});
  if (!AllFinite(point.xyz, 3)) return Joined({"point ", id, " is not finite"});
  if (!AllFinite(&point.error, 1)) return Joined({"the error of point ", id, " is not finite"});
  if (!points_.insert(point.id).second) return Joined({"a second point ", id});
  for (const ColmapTrackElement& element : point.track) {
    const auto at = images_.find(element.image);
    const std::string image = std::to_string(element.image);
    if (at == images_.end())
      return Joined({"point ", id, " is in image ", image, ", which there is not"});
    const std::vector<ColmapFeature>& features = model_.images[at->second].features;
    const std::string feature = std::to_string(element.feature);
    if (element.feature >= features.size()) {
      return Joined({"point ", id, " is feature ", feature, " of image ", image, ", which has ",
                     std::to_string(features.size())});
    }
    const std::int64_t named = features[element.feature].point;
    if (named != point.id) {
      return Joined({"point ", id, " is feature ", feature, " of image ", image,
                     ", which is point ", std::to_string(named)});
    }
    if (in_track_[at->second][element.feature])
      return Joined({"point ", id, " has feature ", feature, " of image ", image, " twice"});
    in_track_[at->second][element.feature] = true;
  }
  return {};
}

std::string ColmapCheck::NextUnlinked(std::size_t* image) const {
  for (; *image < model_.images.size(); ++*image) {
    const std::vector<ColmapFeature>& features = model_.images[*image].features;
    for (std::size_t k = 0; k < features.size(); ++k) {
      const std::int64_t point = features[k].point;
      if (point < 0 || in_track_[*image][k]) continue;
      return Joined(
          {"feature ", std::to_string(k), " of image ", std::to_string(model_.images[*image].id),
           " is point ", std::to_string(point),
           points_.contains(point) ? ", whose track does not have it" : ", which there is not"});
    }
  }
  return {};
}

}  // namespace glissade::internal
