// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "glissade/vision/image_recording.h"

namespace glissade::vision::internal {

/// `mav` is the folder that holds cam0.
Result<ImageRecording> ReadEurocImages(const std::string& mav, int max_cameras);
Result<ImageRecording> ReadKittiImages(const std::string& folder, int max_cameras);

}  // namespace glissade::vision::internal
