// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/ply.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "glissade/edges/bal.h"
#include "glissade/io/bal.h"
#include "io/temp_file.h"

namespace glissade {
namespace {

constexpr PlyColor kRed = {255, 0, 0};

const char* const kHeader =
    "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
    "element edge 1\nproperty int vertex1\nproperty int vertex2\nproperty uchar red\n"
    "property uchar green\nproperty uchar blue\nend_header\n";

TEST(Ply, ByteByByte) {
  TempFiles files;
  PlyScene scene;
  const double x[3] = {1.0, -2.0, 0.5}, y[3] = {0.0, 0.0, 3.0};
  scene.AddPoint(x, kRed);
  scene.AddPoint(y, {1, 2, 10});
  scene.edges.push_back({1, 0, {7, 8, 9}});
  ASSERT_TRUE(WritePly(scene, files.Path("a.ply")).ok());
  const std::string expected = kHeader +
                               std::string("\0\0\x80\x3f\0\0\0\xc0\0\0\0\x3f\xff\0\0", 15) +
                               std::string("\0\0\0\0\0\0\0\0\0\0\x40\x40\1\2\x0a", 15) +
                               std::string("\1\0\0\0\0\0\0\0\7\x08\x09", 11);
  EXPECT_EQ(files.Read("a.ply"), expected);
}

TEST(Ply, ACameraLooksWhereItLooks) {
  // World to camera: camera x is world y, camera y is world z, camera z is world x.
  const double R[9] = {0, 1, 0, 0, 0, 1, 1, 0, 0};
  const double centre[3] = {10.0, 20.0, 30.0};
  for (const bool looks_back : {false, true}) {
    PlyScene scene;
    scene.AddCamera(R, centre, 2.0, looks_back, kRed);
    ASSERT_EQ(scene.vertices.size(), 5u);
    ASSERT_EQ(scene.edges.size(), 8u);
    EXPECT_EQ(scene.vertices[0].position, (std::array<float, 3>{10, 20, 30}));
    for (int k = 1; k < 5; ++k) {
      const auto& p = scene.vertices[static_cast<std::size_t>(k)].position;
      EXPECT_EQ(p[0], looks_back ? 8.0f : 12.0f);
      EXPECT_EQ(std::abs(p[1] - 20.0f), 1.0f);
      EXPECT_EQ(std::abs(p[2] - 30.0f), 0.75f);
    }
  }
}

TEST(Ply, NothingIsWrittenThatIsNoScene) {
  TempFiles files;
  const double x[3] = {1.0, 2.0, 3.0};
  PlyScene scene;
  scene.AddPoint(x, kRed);
  scene.edges.push_back({0, 1, kRed});
  EXPECT_EQ(WritePly(scene, files.Path("a.ply")).code(), StatusCode::kInvalidArgument);
  scene.edges = {{-1, 0, kRed}};
  EXPECT_EQ(WritePly(scene, files.Path("a.ply")).code(), StatusCode::kInvalidArgument);
  scene.edges.clear();
  for (const double bad : {std::nan(""), 1e39, -std::numeric_limits<double>::infinity()}) {
    const double far[3] = {0.0, bad, 0.0};
    PlyScene with = scene;
    with.AddPoint(far, kRed);
    const Status status = WritePly(with, files.Path("a.ply"));
    EXPECT_EQ(status.code(), StatusCode::kNotFinite);
    EXPECT_NE(status.message().find("vertex 1"), std::string::npos);
  }
  EXPECT_EQ(WritePly(scene, files.Path("no/a.ply")).code(), StatusCode::kIoError);
  EXPECT_EQ(files.Count(), 0);
  EXPECT_TRUE(WritePly(PlyScene{}, files.Path("empty.ply")).ok());
}

TEST(Ply, AGraphsPointsHaveTheColourOfTheirErrors) {
  BalProblem bal;
  VertexCameraBal camera;  // looks along -z from (0, 0, 5)
  const double data[9] = {0, 0, 0, 0, 0, -5, 100, 0, 0};
  std::copy_n(data, 9, camera.data);
  bal.cameras = {camera, camera};
  bal.cameras[1].data[3] = -4.0;  // 4 to the right
  for (int j = 0; j < 4; ++j)
    bal.points.emplace_back(0.0, 0.0, 0.0);
  // Errors of 0, 1 and 5 px; the last is not seen.
  bal.observations = {{0, 0, 0.0, 0.0}, {0, 1, 1.0, 0.0}, {0, 2, 3.0, 4.0}};
  Graph graph;
  ASSERT_TRUE(AddToGraph(bal, graph).ok());
  const auto scene = PlyOfGraph(graph);
  ASSERT_TRUE(scene.ok()) << scene.status().message();
  ASSERT_EQ(scene->vertices.size(), 4u + 2 * 5);
  EXPECT_EQ(scene->vertices[0].color, (PlyColor{0, 0, 255}));
  EXPECT_EQ(scene->vertices[1].color, (PlyColor{0, 255, 0}));
  EXPECT_EQ(scene->vertices[2].color, (PlyColor{255, 0, 0}));
  EXPECT_EQ(scene->vertices[3].color, (PlyColor{128, 128, 128}));
  EXPECT_EQ(scene->vertices[4].position, (std::array<float, 3>{0, 0, 5}));
  EXPECT_EQ(scene->vertices[9].position, (std::array<float, 3>{4, 0, 5}));
  // Half of the 4 between the two: the image lies at 5 - 2.
  for (std::size_t k = 5; k < 9; ++k)
    EXPECT_EQ(scene->vertices[k].position[2], 3.0f);
  EXPECT_EQ(scene->edges.size(), 16u);
  EXPECT_EQ(PlyOfGraph(Graph()).status().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace glissade
