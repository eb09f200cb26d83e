// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "glissade/vision/image.h"

namespace glissade::vision::internal {

/// The same pixels, to be read only: OpenCV has no constant view.
inline cv::Mat AsMat(const ImageView& image) {
  return cv::Mat(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                 image.stride);
}

}  // namespace glissade::vision::internal
