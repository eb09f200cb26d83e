// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/course_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/data_dir.h"
#include "glissade/sim/course_scene.h"
#include "io/temp_file.h"

namespace glissade {
namespace {

TEST(CourseSceneFile, GeneratorAndFrozenFileAgreeBitForBit) {
  const auto frozen = ReadCourseScene((test::SourceDir() / "data/course_scene.txt").string());
  ASSERT_TRUE(frozen.ok()) << frozen.status().message();
  ASSERT_EQ(frozen->poses.size(), 3u);
  ASSERT_EQ(frozen->points.size(), 20u);
  EXPECT_TRUE(*frozen == MakeCourseScene());
}

TEST(CourseSceneFile, WrittenFilesComeBackAsTheSameBits) {
  TempFiles files;
  const CourseScene scene = MakeCourseScene();
  for (const char* name : {"a.txt", "a.gz", "a.bz2"}) {
    ASSERT_TRUE(WriteCourseScene(scene, files.Path(name), "two\nlines").ok());
    const auto again = ReadCourseScene(files.Path(name));
    ASSERT_TRUE(again.ok()) << again.status().message();
    EXPECT_TRUE(*again == scene);
  }
  EXPECT_EQ(files.Read("a.txt").rfind("# two\n# lines\nGLISSADE_COURSE_SCENE 1\n", 0), 0u);
}

TEST(CourseSceneFile, WhatIsWrongIsNamedWithFileAndLine) {
  TempFiles files;
  const std::string lines[] = {"GLISSADE_COURSE_SCENE 1",
                               "POSES 2",
                               "POSE 0  0 0 0  0 0 0 1",
                               "POSE 1  1 0 0  0 0 0 1",
                               "POINTS 1",
                               "POINT 0  0 0 5  0.25  2  0 0 0  1 -0.2 0",
                               "END"};
  const auto with = [&](std::size_t changed, const std::string& replacement) {
    std::string text;
    for (std::size_t k = 0; k < std::size(lines); ++k)
      text += (k + 1 == changed ? replacement : lines[k]) + "\n";
    return text;
  };
  const auto good = ReadCourseScene(files.Write("good", with(0, "")));
  ASSERT_TRUE(good.ok()) << good.status().message();
  EXPECT_EQ(good->TrueInverseDepth(good->points[0]), 0.2);

  const struct {
    std::size_t line;
    const char* replacement;
    const char* message;
  } cases[] = {
      {1, "VIOWIN 1", "1: expected GLISSADE_COURSE_SCENE, found 'VIOWIN'"},
      {1, "GLISSADE_COURSE_SCENE 2", "1: expected version of the format (1 to 1), found '2'"},
      {2, "POSES -2", "2: expected number of poses (at least 1), found '-2'"},
      {2, "POSES 3", "5: expected POSE, found 'POINTS'"},
      {2, "POSES 1", "4: expected POINTS, found 'POSE'"},
      {4, "POSE 0  1 0 0  0 0 0 1", "4: expected pose 1 here: poses come in order"},
      {4, "POSE 1  1 0 0  0 0 0 2", "4: pose 1: quaternion has norm 2, not 1"},
      {4, "POSE 1  1 0 nan  0 0 0 1",
       "4: expected px py pz qx qy qz qw of pose 1 (a finite number), found 'nan'"},
      {4, "POSE 1  1 0 0  0 0 0",
       "5: expected px py pz qx qy qz qw of pose 1 (a number), found 'POINTS'"},
      {5, "POINTS 2", "7: expected POINT, found 'END'"},
      {6, "POINT 0  0 0 5  0.25  1  0 0 0",
       "6: expected number of observations of point 0 (2 to 2), found '1'"},
      {6, "POINT 0  0 0 5  0.25  2  0 0 0  2 -0.2 0",
       "6: expected pose of an observation of point 0 (0 to 1), found '2'"},
      {6, "POINT 0  0 0 5  0.25  2  0 0 0  0 -0.2 0", "6: point 0: seen twice by pose 0"},
      {6, "POINT 0  0 0 -5  0.25  2  0 0 0  1 -0.2 0", "6: point 0: not in front of its host"},
      {6, "POINT 0  0 0 5  0.25  2  0 0 0  1 -0.2",
       "7: expected v of an observation of point 0 (a number), found 'END'"},
      {7, "", "8: expected END, found the end of the file"},
      {7, "END 1", "7: expected the end of the file, found '1'"},
  };
  for (const auto& [line, replacement, message] : cases) {
    const std::string path = files.Write("bad", with(line, replacement));
    const auto scene = ReadCourseScene(path);
    EXPECT_EQ(scene.status().code(), StatusCode::kParseError);
    EXPECT_EQ(scene.status().message(), path + ":" + message);
  }
  const std::string whole = with(0, "");
  for (std::size_t size = 0; size + 1 < whole.size(); ++size)
    EXPECT_FALSE(ReadCourseScene(files.Write("cut", whole.substr(0, size))).ok()) << size;
}

TEST(CourseSceneFile, InvalidScenesAreNotWritten) {
  TempFiles files;
  const auto refused = [&](auto&& spoil) {
    CourseScene scene = MakeCourseScene();
    spoil(scene);
    EXPECT_FALSE(Validate(scene).ok());
    EXPECT_FALSE(WriteCourseScene(scene, files.Path("a")).ok());
    EXPECT_EQ(files.Count(), 0);
  };
  EXPECT_TRUE(Validate(MakeCourseScene()).ok());
  refused([](CourseScene& s) { s.poses.clear(); });
  refused([](CourseScene& s) { s.points.clear(); });
  refused([](CourseScene& s) { s.poses[2].data[6] = 0.5; });
  refused([](CourseScene& s) { s.points[3].xyz[1] = std::nan(""); });
  refused([](CourseScene& s) { s.points[3].rho_init = std::nan(""); });
  refused([](CourseScene& s) { s.points[3].observations.resize(1); });
  refused([](CourseScene& s) { s.points[3].observations[1].pose = 3; });
  refused([](CourseScene& s) { s.points[3].observations[1].pose = 0; });
  refused([](CourseScene& s) { s.points[3].observations[1].u = std::nan(""); });
  refused([](CourseScene& s) { s.points[3].xyz[2] = -1.0; });
}

}  // namespace
}  // namespace glissade
