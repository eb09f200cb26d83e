// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/colmap.h"

#include <array>
#include <filesystem>
#include <system_error>

#include "glissade/base/out_of_memory.h"
#include "io/colmap_check.h"

namespace glissade {

namespace {

namespace fs = std::filesystem;

struct ModelInfo {
  std::string_view name;
  int num_parameters;
};
constexpr std::array<ModelInfo, kNumColmapCameraModels> kModels = {{{"SIMPLE_PINHOLE", 3},
                                                                    {"PINHOLE", 4},
                                                                    {"SIMPLE_RADIAL", 4},
                                                                    {"RADIAL", 5},
                                                                    {"OPENCV", 8},
                                                                    {"OPENCV_FISHEYE", 8},
                                                                    {"FULL_OPENCV", 12},
                                                                    {"FOV", 5},
                                                                    {"SIMPLE_RADIAL_FISHEYE", 4},
                                                                    {"RADIAL_FISHEYE", 5},
                                                                    {"THIN_PRISM_FISHEYE", 12}}};

ModelInfo InfoOf(ColmapCameraModel model) {
  const auto k = static_cast<std::int32_t>(model);
  if (k < 0 || k >= kNumColmapCameraModels) return {"unknown", 0};
  return kModels[static_cast<std::size_t>(k)];
}

bool HasModel(const std::string& folder, const char* ending) {
  for (const char* file : internal::kColmapFiles) {
    std::error_code error;
    const fs::path path = fs::path(folder) / std::string(file).append(ending);
    if (!fs::exists(path, error)) return false;
  }
  return true;
}

}  // namespace

std::string_view ColmapModelName(ColmapCameraModel model) {
  return InfoOf(model).name;
}

int ColmapNumParameters(ColmapCameraModel model) {
  return InfoOf(model).num_parameters;
}

Result<ColmapFormat> FindColmapFormat(const std::string& folder) {
  if (HasModel(folder, ".bin")) return ColmapFormat::kBinary;
  if (HasModel(folder, ".txt")) return ColmapFormat::kText;
  std::error_code error;
  const bool is_folder = fs::is_directory(folder, error);
  return Status(
      StatusCode::kIoError,
      internal::Joined({folder, is_folder ? ": no COLMAP model: it has cameras, images and "
                                            "points3D, all .bin or all .txt"
                                          : ": no such folder"}));
}

Result<ColmapModel> ReadColmap(const std::string& folder) {
  return internal::OrOutOfMemory([&]() -> Result<ColmapModel> {
    const auto format = FindColmapFormat(folder);
    if (!format.ok()) return format.status();
    return format.value() == ColmapFormat::kText ? internal::ReadColmapText(folder)
                                                 : internal::ReadColmapBinary(folder);
  });
}

Status CheckColmap(const ColmapModel& model) {
  const auto invalid = [](const std::string& why) {
    return Status(StatusCode::kInvalidArgument, internal::Joined({"COLMAP model: ", why}));
  };
  internal::ColmapCheck check(model);
  for (std::size_t k = 0; k < model.cameras.size(); ++k) {
    if (const std::string why = check.Camera(k); !why.empty()) return invalid(why);
  }
  for (std::size_t k = 0; k < model.images.size(); ++k) {
    if (const std::string why = check.Image(k); !why.empty()) return invalid(why);
  }
  for (std::size_t k = 0; k < model.points.size(); ++k) {
    if (const std::string why = check.Point(k); !why.empty()) return invalid(why);
  }
  std::size_t image = 0;
  if (const std::string why = check.NextUnlinked(&image); !why.empty()) return invalid(why);
  return {};
}

Status WriteColmap(const ColmapModel& model, const std::string& folder, ColmapFormat format) {
  if (Status status = CheckColmap(model); !status.ok()) return status;
  if (format == ColmapFormat::kText) {
    for (const ColmapImage& image : model.images) {
      const bool one_word = !image.name.empty() && image.name[0] != '#' &&
                            image.name.find_first_of(" \t\n\v\f\r") == std::string::npos;
      if (one_word) continue;
      return {StatusCode::kInvalidArgument,
              internal::Joined({"COLMAP model: the name of image ", std::to_string(image.id),
                                " is not one word, or begins with '#': it can be written in "
                                "binary only"})};
    }
    if (HasModel(folder, ".bin")) {
      return {StatusCode::kInvalidArgument,
              internal::Joined({folder,
                                ": has a binary model, which would be read instead of the "
                                "text"})};
    }
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return {StatusCode::kIoError,
            internal::Joined({folder, ": cannot be made: ", error.message()})};
  }
  return format == ColmapFormat::kText ? internal::WriteColmapText(model, folder)
                                       : internal::WriteColmapBinary(model, folder);
}

}  // namespace glissade
