// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// COLMAP models as text: a line for each camera and point, two for each image.

#include <filesystem>
#include <utility>

#include "io/colmap_check.h"
#include "io/text_reader.h"
#include "io/text_writer.h"

namespace glissade::internal {

namespace {

constexpr std::int64_t kMostId = kNoColmapId - std::int64_t{1};
constexpr std::int64_t kMostSize = std::numeric_limits<std::int64_t>::max();

std::string FileOf(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / std::string(name).append(".txt")).string();
}

/// Whether the next word is on this line.
bool IsOnLine(TextReader& in, std::int64_t line) {
  return !in.AtEnd() && in.line() == line;
}

/// Fails where what was read last is not on this line: the line was too short.
void ExpectOnLine(TextReader& in, std::int64_t line, std::string_view what) {
  if (in.ok() && in.line() != line)
    in.Fail(Joined({what, " goes on in line ", std::to_string(in.line()), ": it has one"}));
}

/// Fails where more is on the line.
void ExpectEndOfLine(TextReader& in, std::int64_t line, std::string_view what) {
  if (IsOnLine(in, line))
    in.Fail(
        Joined({"expected the end of the line of ", what, ", found '", Printable(in.Peek()), "'"}));
}

ColmapCamera ReadCamera(TextReader& in) {
  ColmapCamera camera;
  camera.id = static_cast<std::uint32_t>(in.Integer(0, kMostId, "id of a camera"));
  const std::int64_t line = in.line();
  const std::string model(in.Word("model of camera", camera.id));
  if (!in.ok()) return camera;
  int k = 0;
  while (k < kNumColmapCameraModels && ColmapModelName(ColmapCameraModel{k}) != model)
    ++k;
  if (k == kNumColmapCameraModels) {
    in.Fail(Joined({"expected a camera model, found '", Printable(model), "'"}));
    return camera;
  }
  camera.model = ColmapCameraModel{k};
  camera.width = static_cast<std::uint64_t>(in.Integer(0, kMostSize, "width of camera", camera.id));
  camera.height =
      static_cast<std::uint64_t>(in.Integer(0, kMostSize, "height of camera", camera.id));
  const int count = ColmapNumParameters(camera.model);
  const std::string what = Joined({"camera ", std::to_string(camera.id), " (", model, ", ",
                                   std::to_string(count), " parameters)"});
  for (int i = 0; i < count && in.ok(); ++i) {
    if (!IsOnLine(in, line)) {
      in.Fail(Joined(
          {"expected parameter ", std::to_string(i + 1), " of ", what, " in the line before"}));
    }
    camera.parameters.push_back(in.Number("parameter of camera", camera.id));
  }
  ExpectEndOfLine(in, line, what);
  return camera;
}

ColmapImage ReadImage(TextReader& in) {
  ColmapImage image;
  image.id = static_cast<std::uint32_t>(in.Integer(0, kMostId, "id of an image"));
  const std::int64_t line = in.line();
  in.Numbers(image.q, 4, "quaternion of image", image.id);
  in.Numbers(image.t, 3, "translation of image", image.id);
  image.camera = static_cast<std::uint32_t>(in.Integer(0, kMostId, "camera of image", image.id));
  image.name = in.Word("name of image", image.id);
  const std::string what = Joined({"image ", std::to_string(image.id)});
  ExpectOnLine(in, line, what);
  ExpectEndOfLine(in, line, what);
  // The next line, which may be empty: what comes later belongs to the next image.
  while (in.ok() && IsOnLine(in, line + 1)) {
    ColmapFeature feature;
    feature.x = in.Number("x of a feature of image", image.id);
    feature.y = in.Number("y of a feature of image", image.id);
    feature.point = in.Integer(-1, kMostColmapPoint, "point of a feature of image", image.id);
    ExpectOnLine(in, line + 1, what);
    image.features.push_back(feature);
  }
  return image;
}

ColmapPoint ReadPoint(TextReader& in) {
  ColmapPoint point;
  point.id = in.Integer(0, kMostColmapPoint, "id of a point");
  const std::int64_t line = in.line();
  in.Numbers(point.xyz, 3, "coordinates of point", point.id);
  for (std::uint8_t& channel : point.rgb)
    channel = static_cast<std::uint8_t>(in.Integer(0, 255, "color of point", point.id));
  point.error = in.Number("error of point", point.id);
  const std::string what = Joined({"point ", std::to_string(point.id)});
  ExpectOnLine(in, line, what);
  while (in.ok() && IsOnLine(in, line)) {
    ColmapTrackElement element;
    element.image =
        static_cast<std::uint32_t>(in.Integer(0, kMostId, "image in the track of point", point.id));
    element.feature = static_cast<std::uint32_t>(
        in.Integer(0, kMostId, "feature in the track of point", point.id));
    ExpectOnLine(in, line, what);
    point.track.push_back(element);
  }
  return point;
}

/// Fails at the line where the thing begins.
Status At(const TextReader& in, std::int64_t line, const std::string& why) {
  return {StatusCode::kParseError, Joined({in.path(), ":", std::to_string(line), ": ", why})};
}

/// All of a file: Ts, of each the line where it begins. `check` says what is wrong with the last
/// one.
template <class T, class Read, class Check>
Status ReadAll(TextReader& in, std::vector<T>* out, std::vector<std::int64_t>* lines, Read read,
               Check check) {
  while (!in.AtEnd()) {
    lines->push_back(in.line());
    out->push_back(read(in));
    if (!in.ok()) break;
    if (const std::string why = check(out->size() - 1); !why.empty())
      return At(in, lines->back(), why);
  }
  return in.status();
}

}  // namespace

Result<ColmapModel> ReadColmapText(const std::string& folder) {
  ColmapModel model;
  ColmapCheck check(model);
  std::vector<TextReader> files;
  Status status = OpenColmapFiles(
      &files, [&](const char* name) { return TextReader::Open(FileOf(folder, name), '#'); });
  if (!status.ok()) return status;
  std::vector<std::int64_t> lines, line_of_image;
  status = ReadAll(files[0], &model.cameras, &lines, ReadCamera,
                   [&](std::size_t k) { return check.Camera(k); });
  if (!status.ok()) return status;
  status = ReadAll(files[1], &model.images, &line_of_image, ReadImage,
                   [&](std::size_t k) { return check.Image(k); });
  if (!status.ok()) return status;
  lines.clear();
  status = ReadAll(files[2], &model.points, &lines, ReadPoint,
                   [&](std::size_t k) { return check.Point(k); });
  if (!status.ok()) return status;
  std::size_t image = 0;
  if (const std::string why = check.NextUnlinked(&image); !why.empty())
    return At(files[1], line_of_image[image] + 1, why);
  return model;
}

Status WriteColmapText(const ColmapModel& model, const std::string& folder) {
  std::vector<TextWriter> files;
  Status status = OpenColmapFiles(
      &files, [&](const char* name) { return TextWriter::Create(FileOf(folder, name)); });
  if (!status.ok()) return status;

  TextWriter& camera_file = files[0];
  camera_file.Line("# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]");
  for (const ColmapCamera& camera : model.cameras) {
    camera_file.Integer(camera.id).Word(ColmapModelName(camera.model));
    camera_file.Word(std::to_string(camera.width)).Word(std::to_string(camera.height));
    camera_file.Numbers(camera.parameters.data(), static_cast<int>(camera.parameters.size()));
    camera_file.EndLine();
  }
  TextWriter& image_file = files[1];
  image_file.Line("# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
  image_file.Line("# POINTS2D[] as X Y POINT3D_ID");
  for (const ColmapImage& image : model.images) {
    image_file.Integer(image.id).Numbers(image.q, 4).Numbers(image.t, 3);
    image_file.Integer(image.camera).Word(image.name).EndLine();
    for (const ColmapFeature& feature : image.features)
      image_file.Number(feature.x).Number(feature.y).Integer(feature.point);
    image_file.EndLine();
  }
  TextWriter& point_file = files[2];
  point_file.Line("# POINT3D_ID X Y Z R G B ERROR TRACK[] as IMAGE_ID POINT2D_IDX");
  for (const ColmapPoint& point : model.points) {
    point_file.Integer(point.id).Numbers(point.xyz, 3);
    for (const std::uint8_t channel : point.rgb)
      point_file.Integer(channel);
    point_file.Number(point.error);
    for (const ColmapTrackElement& element : point.track)
      point_file.Integer(element.image).Integer(element.feature);
    point_file.EndLine();
  }
  return CloseColmapFiles(&files);
}

}  // namespace glissade::internal
