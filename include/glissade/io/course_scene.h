// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/lie/pose.h"

/// \file
/// The course scene: a few poses that look at a few points; the camera is the body. What the
/// testMonoBA app solves. Text, white space between words, `#` begins a comment:
///
///     GLISSADE_COURSE_SCENE 1
///     POSES <number>
///     POSE <k>  px py pz  qx qy qz qw                                one line per pose
///     POINTS <number>
///     POINT <k>  x y z  rho_init  n  (pose u v) x n                  one line per point, n >= 2
///     END
namespace glissade {

/// Normalized image point (x/z, y/z) of a scene point in one of its poses.
struct CourseObservation {
  int pose = 0;
  double u = 0.0;
  double v = 0.0;

  friend bool operator==(const CourseObservation&, const CourseObservation&) = default;
};

struct CoursePoint {
  double xyz[3] = {0.0, 0.0, 0.0};  ///< truth, world (m)
  double rho_init = 0.0;            ///< start of its inverse depth in the host (1/m)
  /// The first one's pose is the host, the pose whose ray and depth the landmark is.
  std::vector<CourseObservation> observations;

  friend bool operator==(const CoursePoint&, const CoursePoint&) = default;
};

struct CourseScene {
  std::vector<Pose> poses;  ///< T_W_C, truth and start
  std::vector<CoursePoint> points;

  /// True inverse depth of a point in its host (1/m).
  [[nodiscard]] double TrueInverseDepth(const CoursePoint& point) const;

  friend bool operator==(const CourseScene&, const CourseScene&) = default;
};

/// What ReadCourseScene takes back: unit quaternions, finite numbers, at least one pose and one
/// point, every point seen by two or more different poses that exist, and in front of its host.
[[nodiscard]] Status Validate(const CourseScene& scene);

/// Reads a file: plain text, .gz or .bz2 (told by content). On failure a status whose message is
/// "file:line: what".
[[nodiscard]] Result<CourseScene> ReadCourseScene(const std::string& path);

/// Writes a file, compressed if its name ends in .gz or .bz2, with the digits it takes:
/// reading it gives the same bits. `comment` becomes the first lines. Refuses an invalid scene;
/// then nothing is written.
Status WriteCourseScene(const CourseScene& scene, const std::string& path,
                        const std::string& comment = {});

inline double CourseScene::TrueInverseDepth(const CoursePoint& point) const {
  const Pose& T_w_c = poses[static_cast<std::size_t>(point.observations[0].pose)];
  const Vector3 offset = Eigen::Map<const Vector3>(point.xyz) - T_w_c.p();
  return 1.0 / T_w_c.R().col(2).dot(offset);
}

}  // namespace glissade
