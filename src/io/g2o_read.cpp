// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <string>
#include <utility>

#include "glissade/base/out_of_memory.h"
#include "glissade/io/g2o.h"
#include "io/csv_reader.h"
#include "io/g2o_check.h"
#include "io/text_reader.h"

namespace glissade {

namespace {

using internal::CsvReader;
using internal::G2oKind;
using internal::G2oTag;

constexpr std::int64_t kMostId = std::numeric_limits<std::int64_t>::max();

class Reader {
 public:
  Reader(CsvReader& in, std::string path, G2oOtherTags other)
      : in_(in), path_(std::move(path)), other_(other) {}

  Result<G2oProblem> Read() {
    while (in_.NextRow())
      ReadLine();
    if (!in_.ok()) return in_.status();
    internal::G2oIds ids;
    if (Status s = internal::CheckG2o(problem_, path_, &lines_, &ids); !s.ok()) return s;
    if (Status s = Fix(ids.vertices); !s.ok()) return s;
    return std::move(problem_);
  }

 private:
  struct Fixed {
    std::int64_t id, line;
  };

  void ReadLine() {
    const std::string_view tag = in_.Text(0);
    if (tag == "FIX") {
      for (int k = 1; k < in_.num_fields() || k == 1; ++k)
        fixed_.push_back({Id(k, "vertex"), in_.line()});
      return;
    }
    for (const G2oTag& known : internal::kG2oTags) {
      if (tag != known.tag) continue;
      in_.ExpectFields(known.num_fields, std::string(known.tag) + " " + known.fields);
      if (!in_.ok()) return;
      ReadElement(known);
      lines_[known.kind].push_back(in_.line());
      return;
    }
    if (other_ == G2oOtherTags::kKeep) {
      problem_.other_lines.emplace_back(in_.row());
      return;
    }
    std::string message =
        "tag '" + internal::Printable(tag) + "' is not supported; those that are: ";
    for (const G2oTag& known : internal::kG2oTags)
      message.append(known.tag).append(", ");
    in_.Fail(message.append("FIX"));
  }

  void ReadElement(const G2oTag& tag) {
    switch (tag.kind) {
      case G2oKind::kOffset:
        problem_.offsets.push_back({Id(1, "id"), ReadPose(2)});
        return;
      case G2oKind::kPose:
        problem_.poses.push_back({.id = Id(1, "id"), .T_w_b = ReadPose(2)});
        return;
      case G2oKind::kPoint: {
        G2oPoint& x = problem_.points.emplace_back();
        x.id = Id(1, "id");
        in_.Numbers(2, 3, x.xyz, "position");
        x.sba = in_.Text(0) == "VERTEX_XYZ";
        return;
      }
      case G2oKind::kCamera:
        problem_.cameras.push_back({.id = Id(1, "id"),
                                    .T_w_c = ReadPose(2),
                                    .fx = in_.Number(9, "fx"),
                                    .fy = in_.Number(10, "fy"),
                                    .cx = in_.Number(11, "cx"),
                                    .cy = in_.Number(12, "cy"),
                                    .baseline = in_.Number(13, "baseline")});
        return;
      case G2oKind::kRelativePose: {
        G2oRelativePose& x = problem_.relative_poses.emplace_back();
        x.from = Id(1, "vertex");
        x.to = Id(2, "vertex");
        x.T_i_j = ReadPose(3);
        Information(10, &x.information);
        return;
      }
      case G2oKind::kPrior: {
        G2oPosePrior& x = problem_.priors.emplace_back();
        x.pose = Id(1, "vertex");
        x.offset = Id(2, "offset");
        x.T_w_s = ReadPose(3);
        Information(10, &x.information);
        return;
      }
      case G2oKind::kPointMeasurement: {
        G2oPointMeasurement& x = problem_.point_measurements.emplace_back();
        x.pose = Id(1, "vertex");
        x.point = Id(2, "vertex");
        x.offset = Id(3, "offset");
        in_.Numbers(4, 3, x.xyz, "measured position");
        Information(7, &x.information);
        return;
      }
      case G2oKind::kProjection: {
        G2oProjection& x = problem_.projections.emplace_back();
        x.point = Id(1, "vertex");
        x.camera = Id(2, "vertex");
        x.u = in_.Number(3, "u");
        x.v = in_.Number(4, "v");
        Information(5, &x.information);
        return;
      }
    }
  }

  std::int64_t Id(int field, const char* what) { return in_.Integer(field, 0, kMostId, what); }
  Pose ReadPose(int field) {
    Pose pose;
    in_.Numbers(field, 3, pose.data, "position");
    in_.Numbers(field + 3, 4, pose.data + 3, "quaternion");
    return pose;
  }
  template <std::size_t N>
  void Information(int field, std::array<double, N>* information) {
    in_.Numbers(field, static_cast<int>(N), information->data(), "information");
  }

  Status Fix(const internal::G2oIndex& vertices) {
    for (const Fixed& fixed : fixed_) {
      const auto found = vertices.find(fixed.id);
      if (found == vertices.end()) {
        if (other_ == G2oOtherTags::kKeep) {
          problem_.other_lines.push_back("FIX " + std::to_string(fixed.id));
          continue;
        }
        return {StatusCode::kParseError, path_ + ":" + std::to_string(fixed.line) +
                                             ": FIX: there is no vertex " +
                                             std::to_string(fixed.id)};
      }
      const auto [kind, k] = found->second;
      if (kind == G2oKind::kPose) problem_.poses[k].fixed = true;
      if (kind == G2oKind::kPoint) problem_.points[k].fixed = true;
      if (kind == G2oKind::kCamera) problem_.cameras[k].fixed = true;
    }
    return {};
  }

  CsvReader& in_;
  const std::string path_;
  const G2oOtherTags other_;
  G2oProblem problem_;
  internal::G2oLines lines_;
  std::vector<Fixed> fixed_;
};

}  // namespace

Result<G2oProblem> ReadG2o(const std::string& path, G2oOtherTags other) {
  return internal::OrOutOfMemory([&]() -> Result<G2oProblem> {
    auto in = CsvReader::Open(path, ' ');
    if (!in.ok()) return in.status();
    return Reader(in.value(), path, other).Read();
  });
}

bool IsG2o(const std::string& path) {
  try {
    auto in = CsvReader::Open(path, ' ');
    if (!in.ok() || !in->NextRow()) return false;
    const char first = in->Text(0).front();
    return first >= 'A' && first <= 'Z';
  } catch (const std::bad_alloc&) {
    return false;
  }
}

}  // namespace glissade
