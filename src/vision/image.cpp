// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/image.h"

#include <algorithm>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "glissade/base/out_of_memory.h"
#include "io/byte_source.h"
#include "io/text_writer.h"
#include "vision/as_mat.h"

namespace glissade::vision {

namespace {

using Bytes = std::vector<std::uint8_t>;

Result<Bytes> ReadBytes(const std::string& path) {
  auto source = glissade::internal::OpenByteSource(path);
  if (!source.ok()) return source.status();
  Bytes bytes;
  char block[65536];
  for (;;) {
    std::string why;
    const std::ptrdiff_t n = (*source)->Read(block, sizeof block, &why);
    if (n < 0) return Status(StatusCode::kIoError, path + ": " + why);
    if (n == 0) return bytes;
    bytes.insert(bytes.end(), block, block + n);
  }
}

bool Contains(const Bytes& bytes, std::size_t from, std::string_view text) {
  const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(std::min(from, bytes.size()));
  return std::search(begin, bytes.end(), text.begin(), text.end(), [](std::uint8_t a, char b) {
           return a == static_cast<std::uint8_t>(b);
         }) != bytes.end();
}

bool BeginsWith(const Bytes& bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

/// Decoders fill up what is missing with grey and say nothing of it. So the mark of the end has to
/// be there: near it, since some cameras write something behind.
bool IsCutOff(const Bytes& bytes) {
  const std::size_t near_end = bytes.size() > 4096 ? bytes.size() - 4096 : 0;
  if (BeginsWith(bytes, "\xFF\xD8")) return !Contains(bytes, near_end, "\xFF\xD9");
  if (BeginsWith(bytes, "\x89PNG")) return !Contains(bytes, near_end, "IEND");
  return false;
}

/// `path` and `code` are for what OpenCV throws.
template <class F>
auto OrStatus(const std::string& path, StatusCode code, F&& f) -> decltype(f()) {
  return glissade::internal::OrOutOfMemory([&]() -> decltype(f()) {
    try {
      return f();
    } catch (const cv::Exception& e) {
      return Status(code, path + ": OpenCV: " + e.err);
    }
  });
}

}  // namespace

Result<Image> ReadImage(const std::string& path) {
  return OrStatus(path, StatusCode::kParseError, [&]() -> Result<Image> {
    const auto bytes = ReadBytes(path);
    if (!bytes.ok()) return bytes.status();
    if (bytes->empty()) return Status(StatusCode::kParseError, path + ": the file is empty");
    if (IsCutOff(*bytes)) return Status(StatusCode::kParseError, path + ": the image is cut off");
    const cv::Mat grey = cv::imdecode(*bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
    if (grey.empty()) {
      return Status(StatusCode::kParseError, path + ": no image that can be decoded");
    }
    Image image;
    image.width = grey.cols;
    image.height = grey.rows;
    image.pixels.resize(static_cast<std::size_t>(grey.cols) * static_cast<std::size_t>(grey.rows));
    cv::Mat pixels(grey.size(), CV_8UC1, image.pixels.data());
    grey.copyTo(pixels);
    return image;
  });
}

Status WriteImage(const ImageView& image, const std::string& path, int jpeg_quality) {
  return OrStatus(path, StatusCode::kIoError, [&]() -> Status {
    if (image.empty() || image.stride < static_cast<std::size_t>(image.width)) {
      return {StatusCode::kInvalidArgument, path + ": an empty image, or rows that overlap"};
    }
    const bool jpeg = path.ends_with(".jpg") || path.ends_with(".jpeg");
    std::vector<int> parameters = {cv::IMWRITE_PNG_COMPRESSION, 1};
    if (jpeg) parameters = {cv::IMWRITE_JPEG_QUALITY, jpeg_quality};
    Bytes bytes;
    if (!cv::imencode(jpeg ? ".jpg" : ".png", internal::AsMat(image), bytes, parameters)) {
      return {StatusCode::kIoError, path + ": the image cannot be encoded"};
    }
    auto writer = glissade::internal::TextWriter::Create(path);
    if (!writer.ok()) return writer.status();
    writer->Bytes(bytes.data(), bytes.size());
    return writer->Close();
  });
}

Result<std::vector<std::uint8_t>> EncodeJpeg(const ImageView& image, int shrink, int quality) {
  return OrStatus(
      "JPEG", StatusCode::kEvaluationFailed, [&]() -> Result<std::vector<std::uint8_t>> {
        if (image.empty() || shrink < 1 || shrink > std::min(image.width, image.height)) {
          return Status(StatusCode::kInvalidArgument, "an empty image, or nothing left of it");
        }
        cv::Mat small;
        cv::resize(internal::AsMat(image), small,
                   cv::Size(image.width / shrink, image.height / shrink), 0, 0, cv::INTER_AREA);
        Bytes bytes;
        if (!cv::imencode(".jpg", small, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})) {
          return Status(StatusCode::kEvaluationFailed, "the image cannot be encoded");
        }
        return bytes;
      });
}

}  // namespace glissade::vision
