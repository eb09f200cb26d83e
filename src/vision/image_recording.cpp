// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/image_recording.h"

#include <filesystem>

#include "glissade/base/out_of_memory.h"
#include "vision/image_layouts.h"

namespace glissade::vision {

namespace fs = std::filesystem;

Result<ImageRecording> ReadImageRecording(const std::string& folder, int max_cameras) {
  return glissade::internal::OrOutOfMemory([&]() -> Result<ImageRecording> {
    if (max_cameras < 1 || max_cameras > 2) {
      return Status(StatusCode::kInvalidArgument, "max_cameras must be 1 or 2");
    }
    std::error_code error;
    const fs::path root(folder);
    if (fs::is_directory(root / "mav0", error)) {
      return internal::ReadEurocImages((root / "mav0").string(), max_cameras);
    }
    if (fs::is_directory(root / "cam0", error))
      return internal::ReadEurocImages(folder, max_cameras);
    if (fs::is_directory(root / "image_0", error))
      return internal::ReadKittiImages(folder, max_cameras);
    if (!fs::is_directory(root, error)) {
      return Status(StatusCode::kIoError, folder + ": is no folder that can be read");
    }
    return Status(StatusCode::kIoError,
                  folder +
                      ": no recording of images: neither mav0/cam0 (EuRoC, TUM-VI) nor "
                      "image_0 (KITTI odometry) is in it");
  });
}

}  // namespace glissade::vision
