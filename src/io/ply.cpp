// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/ply.h"

#include <bit>
#include <cmath>
#include <string_view>

#include "glissade/base/index.h"
#include "io/text_writer.h"

namespace glissade {

namespace {

using internal::TextWriter;

/// The bytes of one element of the file.
class Element {
 public:
  void Word(std::uint32_t x) {
    for (int shift = 0; shift < 32; shift += 8)
      Byte(static_cast<std::uint8_t>(x >> shift));
  }
  void Float(float x) { Word(std::bit_cast<std::uint32_t>(x)); }
  void Color(const PlyColor& color) {
    for (const std::uint8_t c : color)
      Byte(c);
  }
  void WriteTo(TextWriter* out) const { out->Bytes(bytes_, size_); }

 private:
  void Byte(std::uint8_t byte) { bytes_[size_++] = byte; }

  std::uint8_t bytes_[16] = {};
  std::size_t size_ = 0;
};

Status CheckScene(const PlyScene& scene) {
  for (std::size_t k = 0; k < scene.vertices.size(); ++k) {
    for (const float x : scene.vertices[k].position) {
      if (std::isfinite(x)) continue;
      return {StatusCode::kNotFinite,
              "PLY: vertex " + std::to_string(k) + " is not finite in single precision"};
    }
  }
  const auto size = static_cast<std::int64_t>(scene.vertices.size());
  const auto known = [&](std::int32_t vertex) { return vertex >= 0 && vertex < size; };
  for (std::size_t k = 0; k < scene.edges.size(); ++k) {
    if (known(scene.edges[k].from) && known(scene.edges[k].to)) continue;
    return {StatusCode::kInvalidArgument, "PLY: edge " + std::to_string(k) + ": no such vertex"};
  }
  return {};
}

}  // namespace

void PlyScene::AddPoint(const double* x, PlyColor color) {
  vertices.push_back(
      {{static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])}, color});
}

void PlyScene::AddCamera(const double* R, const double* centre, double size, bool looks_back,
                         PlyColor color) {
  const auto first = static_cast<std::int32_t>(vertices.size());
  AddPoint(centre, color);
  const double z = looks_back ? -size : size;
  for (const auto& [sx, sy] : {std::array{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
    const double corner[3] = {0.5 * size * sx, 0.375 * size * sy, z};
    double x[3];
    for (int i = 0; i < 3; ++i)
      x[i] = centre[i] + R[i] * corner[0] + R[3 + i] * corner[1] + R[6 + i] * corner[2];
    AddPoint(x, color);
  }
  for (std::int32_t k = 0; k < 4; ++k) {
    edges.push_back({first, first + 1 + k, color});
    edges.push_back({first + 1 + k, first + 1 + (k + 1) % 4, color});
  }
}

Status WritePly(const PlyScene& scene, const std::string& path) {
  if (Status status = CheckScene(scene); !status.ok()) return status;
  auto writer = TextWriter::Create(path);
  if (!writer.ok()) return writer.status();
  TextWriter& out = writer.value();
  const auto lines = [&](std::initializer_list<std::string_view> text) {
    for (const std::string_view line : text)
      out.Line(line);
  };
  lines({"ply", "format binary_little_endian 1.0"});
  out.Word("element vertex").Integer(static_cast<std::int64_t>(scene.vertices.size())).EndLine();
  lines({"property float x", "property float y", "property float z", "property uchar red",
         "property uchar green", "property uchar blue"});
  out.Word("element edge").Integer(static_cast<std::int64_t>(scene.edges.size())).EndLine();
  lines({"property int vertex1", "property int vertex2", "property uchar red",
         "property uchar green", "property uchar blue", "end_header"});
  for (const PlyVertex& vertex : scene.vertices) {
    Element bytes;
    for (const float x : vertex.position)
      bytes.Float(x);
    bytes.Color(vertex.color);
    bytes.WriteTo(&out);
  }
  for (const PlyEdge& edge : scene.edges) {
    Element bytes;
    bytes.Word(static_cast<std::uint32_t>(edge.from));
    bytes.Word(static_cast<std::uint32_t>(edge.to));
    bytes.Color(edge.color);
    bytes.WriteTo(&out);
  }
  return out.Close();
}

}  // namespace glissade
