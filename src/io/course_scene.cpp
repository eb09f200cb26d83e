// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/course_scene.h"
#include "glissade/base/out_of_memory.h"

#include <cmath>
#include <string_view>
#include <utility>

#include "glissade/base/validate.h"
#include "io/text_reader.h"
#include "io/text_writer.h"

namespace glissade {

namespace {

using internal::ReserveFor;
using internal::TextReader;
using internal::TextWriter;

constexpr std::string_view kMagic = "GLISSADE_COURSE_SCENE";
constexpr int kVersion = 1;

Status CheckPoint(const CourseScene& scene, std::size_t k) {
  const CoursePoint& point = scene.points[k];
  const std::string name = "point " + std::to_string(k);
  const auto invalid = [&](const std::string& what) {
    return Status(StatusCode::kInvalidArgument, name + ": " + what);
  };
  if (Status s = ValidateFinite(point.xyz, 3, name); !s.ok()) return s;
  if (Status s = ValidateFinite(&point.rho_init, 1, name + ": rho_init"); !s.ok()) return s;
  if (point.observations.size() < 2) return invalid("seen by fewer than two poses");
  std::vector<bool> seen(scene.poses.size(), false);
  for (const CourseObservation& o : point.observations) {
    if (o.pose < 0 || static_cast<std::size_t>(o.pose) >= scene.poses.size()) {
      return invalid("no pose " + std::to_string(o.pose));
    }
    const auto pose = static_cast<std::size_t>(o.pose);
    if (seen[pose]) return invalid("seen twice by pose " + std::to_string(o.pose));
    seen[pose] = true;
    const double uv[2] = {o.u, o.v};
    if (Status s = ValidateFinite(uv, 2, name + ": observation"); !s.ok()) return s;
  }
  const double rho = scene.TrueInverseDepth(point);
  if (!(rho > 0.0) || !std::isfinite(rho)) return invalid("not in front of its host");
  return {};
}

Pose ReadPose(TextReader& in, int index) {
  in.Expect("POSE");
  if (in.Integer(0, index, "number of this pose") != index && in.ok()) {
    in.Fail("expected pose " + std::to_string(index) + " here: poses come in order");
  }
  Pose pose;
  in.Numbers(pose.data, 7, "px py pz qx qy qz qw of pose", index);
  if (!in.ok()) return pose;
  if (Status s = ValidatePose(pose.data, "pose " + std::to_string(index)); !s.ok()) {
    in.Fail(s.message());
  }
  return pose;
}

void ReadPoint(TextReader& in, CourseScene& scene) {
  const auto index = static_cast<int>(scene.points.size());
  in.Expect("POINT");
  if (in.Integer(0, index, "number of this point") != index && in.ok()) {
    in.Fail("expected point " + std::to_string(index) + " here: points come in order");
  }
  CoursePoint point;
  in.Numbers(point.xyz, 3, "x y z of point", index);
  point.rho_init = in.Number("rho_init of point", index);
  const auto num_poses = static_cast<int>(scene.poses.size());
  const auto n = in.Integer(2, num_poses, "number of observations of point", index);
  for (std::int64_t k = 0; k < n && in.ok(); ++k) {
    CourseObservation o;
    o.pose = in.Index(num_poses, "pose of an observation of point", index);
    o.u = in.Number("u of an observation of point", index);
    o.v = in.Number("v of an observation of point", index);
    point.observations.push_back(o);
  }
  if (!in.ok()) return;
  scene.points.push_back(std::move(point));
  if (Status s = CheckPoint(scene, scene.points.size() - 1); !s.ok()) in.Fail(s.message());
}

}  // namespace

Status Validate(const CourseScene& scene) {
  if (scene.poses.empty()) return {StatusCode::kInvalidArgument, "course scene: no poses"};
  if (scene.points.empty()) return {StatusCode::kInvalidArgument, "course scene: no points"};
  for (std::size_t k = 0; k < scene.poses.size(); ++k) {
    if (Status s = ValidatePose(scene.poses[k].data, "course scene: pose " + std::to_string(k));
        !s.ok()) {
      return s;
    }
  }
  for (std::size_t k = 0; k < scene.points.size(); ++k) {
    if (Status s = CheckPoint(scene, k); !s.ok()) {
      return {s.code(), "course scene: " + s.message()};
    }
  }
  return {};
}

Result<CourseScene> ReadCourseScene(const std::string& path) {
  return internal::OrOutOfMemory([&]() -> Result<CourseScene> {
    auto reader = TextReader::Open(path, '#');
    if (!reader.ok()) return reader.status();
    TextReader& in = reader.value();

    in.Expect(kMagic);
    in.Integer(kVersion, kVersion, "version of the format");
    CourseScene scene;
    in.Expect("POSES");
    const int num_poses = in.Count(1, "number of poses");
    scene.poses.reserve(ReserveFor(num_poses));
    for (int k = 0; k < num_poses && in.ok(); ++k)
      scene.poses.push_back(ReadPose(in, k));
    in.Expect("POINTS");
    const int num_points = in.Count(1, "number of points");
    scene.points.reserve(ReserveFor(num_points));
    for (int k = 0; k < num_points && in.ok(); ++k)
      ReadPoint(in, scene);
    in.Expect("END");
    in.ExpectEnd();
    if (!in.ok()) return in.status();
    return scene;
  });
}

Status WriteCourseScene(const CourseScene& scene, const std::string& path,
                        const std::string& comment) {
  if (Status status = Validate(scene); !status.ok()) return status;
  auto writer = TextWriter::Create(path);
  if (!writer.ok()) return writer.status();
  TextWriter& out = writer.value();

  for (std::string_view rest = comment; !rest.empty();) {
    const std::size_t end = rest.find('\n');
    out.Line("# " + std::string(rest.substr(0, end)));
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  out.Word(kMagic).Integer(kVersion).EndLine();
  out.Line("# POSE k  px py pz  qx qy qz qw      T_W_C: x_W = R(q) x_C + p (m); truth and start");
  out.Word("POSES").Integer(static_cast<std::int64_t>(scene.poses.size())).EndLine();
  for (std::size_t k = 0; k < scene.poses.size(); ++k) {
    out.Word("POSE")
        .Integer(static_cast<std::int64_t>(k))
        .Numbers(scene.poses[k].data, 7)
        .EndLine();
  }
  out.Line("# POINT k  x y z  rho_init  n  (pose u v) x n");
  out.Line("#   x y z: truth in W (m); rho_init: start of 1/z in the host (1/m), the first pose;");
  out.Line("#   u v: normalized image point (x/z, y/z)");
  out.Word("POINTS").Integer(static_cast<std::int64_t>(scene.points.size())).EndLine();
  for (std::size_t k = 0; k < scene.points.size(); ++k) {
    const CoursePoint& point = scene.points[k];
    out.Word("POINT").Integer(static_cast<std::int64_t>(k)).Numbers(point.xyz, 3);
    out.Number(point.rho_init).Integer(static_cast<std::int64_t>(point.observations.size()));
    for (const CourseObservation& o : point.observations)
      out.Integer(o.pose).Number(o.u).Number(o.v);
    out.EndLine();
  }
  out.Line("END");
  return out.Close();
}

}  // namespace glissade
