// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// COLMAP models in binary: a count of 64 bits, then what it counts.

#include <bit>
#include <filesystem>
#include <utility>

#include "io/binary_reader.h"
#include "io/colmap_check.h"
#include "io/text_writer.h"

namespace glissade::internal {

namespace {

constexpr std::uint64_t kNoPoint = std::numeric_limits<std::uint64_t>::max();

std::string FileOf(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / std::string(name).append(".bin")).string();
}

/// kNoPoint is -1; other numbers from 2^63 on are no ids.
std::int64_t ReadPointId(BinaryReader& in, std::string_view what) {
  const std::uint64_t at = in.offset();
  const std::uint64_t id = in.Integer64(what);
  if (id == kNoPoint) return -1;
  if (id > static_cast<std::uint64_t>(kMostColmapPoint))
    in.Fail(at, Joined({std::to_string(id), " is no id of a point"}));
  return static_cast<std::int64_t>(id);
}

ColmapCamera ReadCamera(BinaryReader& in) {
  ColmapCamera camera;
  camera.id = in.Integer32("id of a camera");
  const std::uint64_t at = in.offset();
  camera.model = ColmapCameraModel{std::bit_cast<std::int32_t>(in.Integer32("model of a camera"))};
  const int count = ColmapNumParameters(camera.model);
  if (in.ok() && count == 0) {
    in.Fail(at, Joined({"camera model ", std::to_string(static_cast<std::int32_t>(camera.model)),
                        " is unknown"}));
  }
  camera.width = in.Integer64("width of a camera");
  camera.height = in.Integer64("height of a camera");
  camera.parameters.resize(static_cast<std::size_t>(count));
  in.Numbers(camera.parameters.data(), count, "parameter of a camera");
  return camera;
}

ColmapImage ReadImage(BinaryReader& in) {
  ColmapImage image;
  image.id = in.Integer32("id of an image");
  in.Numbers(image.q, 4, "quaternion of an image");
  in.Numbers(image.t, 3, "translation of an image");
  image.camera = in.Integer32("camera of an image");
  image.name = in.Text("name of an image");
  image.features.resize(in.Count(24, "number of features"));
  for (ColmapFeature& feature : image.features) {
    feature.x = in.Number("x of a feature");
    feature.y = in.Number("y of a feature");
    feature.point = ReadPointId(in, "point of a feature");
    if (!in.ok()) break;
  }
  return image;
}

ColmapPoint ReadPoint(BinaryReader& in) {
  ColmapPoint point;
  point.id = ReadPointId(in, "id of a point");
  in.Numbers(point.xyz, 3, "coordinates of a point");
  for (std::uint8_t& channel : point.rgb)
    channel = in.Byte("color of a point");
  point.error = in.Number("error of a point");
  point.track.resize(in.Count(8, "length of a track"));
  for (ColmapTrackElement& element : point.track) {
    element.image = in.Integer32("image in a track");
    element.feature = in.Integer32("feature in a track");
    if (!in.ok()) break;
  }
  return point;
}

Status At(const BinaryReader& in, std::uint64_t offset, const std::string& why) {
  return {StatusCode::kParseError,
          Joined({in.path(), ":byte ", std::to_string(offset), ": ", why})};
}

/// All of a file: a count and that many Ts. `check` says what is wrong with the last one.
template <class T, class Read, class Check>
Status ReadAll(BinaryReader& in, std::uint64_t bytes_each, std::string_view what,
               std::vector<T>* out, std::vector<std::uint64_t>* offsets, Read read, Check check) {
  const std::uint64_t count = in.Count(bytes_each, what);
  for (std::uint64_t k = 0; k < count && in.ok(); ++k) {
    const std::uint64_t at = in.offset();
    out->push_back(read(in));
    if (!in.ok()) break;
    if (const std::string why = check(out->size() - 1); !why.empty()) return At(in, at, why);
    if (offsets != nullptr) offsets->push_back(at);
  }
  in.ExpectEnd();
  return in.status();
}

/// Writes numbers, little endian.
class BinaryWriter {
 public:
  explicit BinaryWriter(TextWriter& out) : out_(out) {}
  BinaryWriter& Integer(std::uint64_t x, int size) {
    char bytes[8];
    for (int k = 0; k < size; ++k)
      bytes[k] = static_cast<char>(x >> (8 * k) & 0xFFu);
    out_.Bytes(bytes, static_cast<std::size_t>(size));
    return *this;
  }
  BinaryWriter& Number(double x) { return Integer(std::bit_cast<std::uint64_t>(x), 8); }
  BinaryWriter& Numbers(const double* x, std::size_t n) {
    for (std::size_t k = 0; k < n; ++k)
      Number(x[k]);
    return *this;
  }
  BinaryWriter& Text(const std::string& text) {
    out_.Bytes(text.c_str(), text.size() + 1);
    return *this;
  }

 private:
  TextWriter& out_;
};

}  // namespace

Result<ColmapModel> ReadColmapBinary(const std::string& folder) {
  ColmapModel model;
  ColmapCheck check(model);
  std::vector<BinaryReader> files;
  Status status = OpenColmapFiles(
      &files, [&](const char* name) { return BinaryReader::Open(FileOf(folder, name)); });
  if (!status.ok()) return status;

  // The least bytes that one takes up: no parameters but three, no name, no features, no track.
  status = ReadAll(files[0], 48, "number of cameras", &model.cameras, nullptr, ReadCamera,
                   [&](std::size_t k) { return check.Camera(k); });
  if (!status.ok()) return status;
  std::vector<std::uint64_t> offset_of_image;
  status = ReadAll(files[1], 73, "number of images", &model.images, &offset_of_image, ReadImage,
                   [&](std::size_t k) { return check.Image(k); });
  if (!status.ok()) return status;
  status = ReadAll(files[2], 51, "number of points", &model.points, nullptr, ReadPoint,
                   [&](std::size_t k) { return check.Point(k); });
  if (!status.ok()) return status;
  std::size_t image = 0;
  if (const std::string why = check.NextUnlinked(&image); !why.empty())
    return At(files[1], offset_of_image[image], why);
  return model;
}

Status WriteColmapBinary(const ColmapModel& model, const std::string& folder) {
  std::vector<TextWriter> files;
  Status status = OpenColmapFiles(
      &files, [&](const char* name) { return TextWriter::Create(FileOf(folder, name)); });
  if (!status.ok()) return status;

  BinaryWriter camera_file(files[0]);
  camera_file.Integer(model.cameras.size(), 8);
  for (const ColmapCamera& camera : model.cameras) {
    camera_file.Integer(camera.id, 4).Integer(static_cast<std::uint32_t>(camera.model), 4);
    camera_file.Integer(camera.width, 8).Integer(camera.height, 8);
    camera_file.Numbers(camera.parameters.data(), camera.parameters.size());
  }
  BinaryWriter image_file(files[1]);
  image_file.Integer(model.images.size(), 8);
  for (const ColmapImage& image : model.images) {
    image_file.Integer(image.id, 4).Numbers(image.q, 4).Numbers(image.t, 3);
    image_file.Integer(image.camera, 4).Text(image.name).Integer(image.features.size(), 8);
    for (const ColmapFeature& feature : image.features) {
      image_file.Number(feature.x).Number(feature.y);
      image_file.Integer(feature.point < 0 ? kNoPoint : static_cast<std::uint64_t>(feature.point),
                         8);
    }
  }
  BinaryWriter point_file(files[2]);
  point_file.Integer(model.points.size(), 8);
  for (const ColmapPoint& point : model.points) {
    point_file.Integer(static_cast<std::uint64_t>(point.id), 8).Numbers(point.xyz, 3);
    for (const std::uint8_t channel : point.rgb)
      point_file.Integer(channel, 1);
    point_file.Number(point.error).Integer(point.track.size(), 8);
    for (const ColmapTrackElement& element : point.track)
      point_file.Integer(element.image, 4).Integer(element.feature, 4);
  }
  return CloseColmapFiles(&files);
}

}  // namespace glissade::internal
