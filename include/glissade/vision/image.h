// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "glissade/base/status.h"

namespace glissade::vision {

/// Somebody's grey image, 8 bits a pixel, rows `stride` bytes apart. Of a cv::Mat:
/// {mat.data, mat.cols, mat.rows, mat.step}.
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;  ///< px
  std::size_t stride = 0;     ///< bytes

  [[nodiscard]] bool empty() const { return data == nullptr || width <= 0 || height <= 0; }
};

/// A grey image, 8 bits a pixel, row by row.
struct Image {
  int width = 0, height = 0;  ///< px
  std::vector<std::uint8_t> pixels;

  [[nodiscard]] ImageView view() const {
    return {pixels.data(), width, height, static_cast<std::size_t>(width)};
  }
};

/// Reads PNG, JPEG and what else OpenCV reads; colours become grey, 16 bits 8. kIoError where the
/// file cannot be opened; kParseError where it is no image or is cut off, which not every decoder
/// says. How a file says that it be turned is ignored: a calibration is of the pixels as they are.
/// Decoders may print warnings of their own to standard error.
[[nodiscard]] Result<Image> ReadImage(const std::string& path);

/// As PNG, or as JPEG of that quality (0 to 100) where the name ends in .jpg or .jpeg. The file
/// appears whole or not at all.
Status WriteImage(const ImageView& image, const std::string& path, int jpeg_quality = 95);

/// The bytes of a JPEG file, the image made smaller by a whole factor. kInvalidArgument for an
/// empty image.
[[nodiscard]] Result<std::vector<std::uint8_t>> EncodeJpeg(const ImageView& image, int shrink = 1,
                                                           int quality = 80);

}  // namespace glissade::vision
