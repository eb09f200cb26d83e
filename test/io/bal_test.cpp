// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/bal.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <utility>
#include <vector>

#include "common/data_dir.h"
#include "glissade/losses/huber.h"
#include "glissade/vertices/pose.h"
#include "io/temp_file.h"

namespace glissade {
namespace {

/// 2 cameras, 3 points, 4 observations; lines 2-5, 6-23 and 24-32.
const char* const kSmall = R"(2 3 4
0 0     -3.5e+00 +2.25
0 1     1 2
1 1     3 4.125e-02
1 2     5 6
0.01
0.02
0.03
-0.1
-0.2
-5
400
-1e-7
+2E-13
0
0
0
1
2
-6
500
0
0
1
2
3
4
5
6
7
8
9e0
)";

std::string WithLine(int line, const std::string& replacement) {
  std::string text = kSmall;
  std::size_t begin = 0;
  for (int k = 1; k < line; ++k)
    begin = text.find('\n', begin) + 1;
  return text.replace(begin, text.find('\n', begin) - begin, replacement);
}

bool SameBits(const BalProblem& a, const BalProblem& b) {
  return a.cameras.size() == b.cameras.size() && a.points.size() == b.points.size() &&
         a.observations == b.observations &&
         std::memcmp(a.cameras.data(), b.cameras.data(), sizeof(a.cameras[0]) * a.cameras.size()) ==
             0 &&
         std::memcmp(a.points.data(), b.points.data(), sizeof(a.points[0]) * a.points.size()) == 0;
}

TEST(Bal, ReadsAFile) {
  TempFiles files;
  for (const std::string& path :
       {files.Write("a.txt", kSmall), files.WriteCompressed("a.gz", kSmall),
        files.WriteCompressed("a.bz2", kSmall)}) {
    auto problem = ReadBal(path);
    ASSERT_TRUE(problem.ok()) << problem.status().message();
    ASSERT_EQ(problem->cameras.size(), 2u);
    ASSERT_EQ(problem->points.size(), 3u);
    ASSERT_EQ(problem->observations.size(), 4u);
    EXPECT_EQ(problem->observations[0], (BalObservation{0, 0, -3.5, 2.25}));
    EXPECT_EQ(problem->observations[2], (BalObservation{1, 1, 3.0, 0.04125}));
    EXPECT_EQ(problem->cameras[0].data[5], -5.0);
    EXPECT_EQ(problem->cameras[0].data[8], 2e-13);
    EXPECT_EQ(problem->cameras[1].data[6], 500.0);
    EXPECT_EQ(problem->points[2].data[2], 9.0);
  }
}

TEST(Bal, WhatIsWrongIsNamedWithFileAndLine) {
  TempFiles files;
  const struct {
    int line;
    const char* replacement;
    const char* message;
  } cases[] = {
      {1, "2 3", "2: expected number of observations (at least 1), found '0'"},
      {1, "2 3\n4", "2: expected the numbers of cameras, points and observations on one line"},
      {1, "2 3 0", "1: expected number of observations (at least 1), found '0'"},
      {1, "-2 3 4", "1: expected number of cameras (at least 1), found '-2'"},
      {1, "2 3 3000000000", "1: expected number of observations (at least 1), found '3000000000'"},
      {1, "two 3 4", "1: expected number of cameras (an integer), found 'two'"},
      // Counts in the first line that are not what follows.
      {1, "2 3 5", "6: expected camera of observation 4 (an integer), found '0.01'"},
      {1, "2 3 3", "29: expected the end of the file after the last point, found '6'"},
      {1, "3 3 4", "33: expected x of point 0 (a number), found the end of the file"},
      {1, "2 4 4", "33: expected x of point 3 (a number), found the end of the file"},
      {1, "2 2 4", "5: expected point of observation 3 (0 to 1), found '2'"},
      {1, "1 3 4", "4: expected camera of observation 2 (0 to 0), found '1'"},
      {3, "0 3 1 2", "3: expected point of observation 1 (0 to 2), found '3'"},
      {3, "-1 2 1 2", "3: expected camera of observation 1 (0 to 1), found '-1'"},
      {3, "0 1 nan 2", "3: expected u of observation 1 (a finite number), found 'nan'"},
      {3, "0 1 1 inf", "3: expected v of observation 1 (a finite number), found 'inf'"},
      {3, "0 1 1", "4: expected observation 1 (camera, point, u, v) alone on its line"},
      {3, "0 1 1 2 3", "3: expected observation 1 (camera, point, u, v) alone on its line"},
      {12, "4OO", "12: expected focal length of camera 0 (a number), found '4OO'"},
      {22, "NaN", "22: expected k1 of camera 1 (a finite number), found 'NaN'"},
      {27, "1e999", "27: expected x of point 1 (a number that a double can hold), found '1e999'"},
      {32, "", "33: expected z of point 2 (a number), found the end of the file"},
      {32, "9 garbage", "32: expected the end of the file after the last point, found 'garbage'"},
  };
  for (const auto& [line, replacement, message] : cases) {
    const std::string path = files.Write("bad.txt", WithLine(line, replacement));
    const auto problem = ReadBal(path);
    ASSERT_FALSE(problem.ok()) << message;
    EXPECT_EQ(problem.status().code(), StatusCode::kParseError);
    EXPECT_EQ(problem.status().message().rfind(path + ":" + message, 0), 0u)
        << problem.status().message() << "\n"
        << message;
    EXPECT_EQ(problem.status().message().find('\n'), std::string::npos);
  }
  EXPECT_EQ(ReadBal(files.Path("none")).status().code(), StatusCode::kIoError);
  EXPECT_EQ(ReadBal(files.Write("empty", "")).status().code(), StatusCode::kParseError);
}

TEST(Bal, AnyPrefixIsRefused) {
  TempFiles files;
  const std::string text = kSmall;
  for (std::size_t size = 0; size + 3 < text.size(); ++size) {  // "9e0\n": 9 alone is a number
    const auto problem = ReadBal(files.Write("cut", text.substr(0, size)));
    EXPECT_EQ(problem.status().code(), StatusCode::kParseError) << size;
  }
}

TEST(Bal, AHugeCountCostsNoMemory) {
  TempFiles files;
  const auto problem = ReadBal(files.Write("huge", "2000000000 2000000000 2000000000\n0 0 1 2\n"));
  EXPECT_EQ(problem.status().code(), StatusCode::kParseError);
}

TEST(Bal, WrittenFilesComeBackAsTheSameBits) {
  TempFiles files;
  auto problem = ReadBal(files.Write("a", kSmall));
  problem->observations[1].u = 1.0 / 3.0;
  problem->cameras[1].data[7] = -1.23456789012345678e-7;
  for (const char* name : {"b.txt", "b.txt.gz", "b.txt.bz2"}) {
    ASSERT_TRUE(WriteBal(*problem, files.Path(name)).ok());
    const auto again = ReadBal(files.Path(name));
    ASSERT_TRUE(again.ok()) << again.status().message();
    EXPECT_TRUE(SameBits(*problem, *again));
  }
}

TEST(Bal, NothingIsWrittenThatCannotBeRead) {
  TempFiles files;
  const BalProblem good = ReadBal(files.Write("a", kSmall)).value();
  const auto refused = [&](auto&& spoil) {
    BalProblem bad = good;
    spoil(bad);
    Graph graph;
    EXPECT_FALSE(AddToGraph(bad, graph).ok());
    EXPECT_EQ(graph.NumVertices() + graph.NumEdges(), 0);
    EXPECT_FALSE(WriteBal(bad, files.Path("bad")).ok());
    EXPECT_EQ(files.Count(), 1);
  };
  refused([](BalProblem& p) { p.observations[2].camera = 2; });
  refused([](BalProblem& p) { p.observations[2].point = -1; });
  refused([](BalProblem& p) { p.observations[3].v = std::nan(""); });
  refused([](BalProblem& p) { p.cameras[1].data[6] = std::numeric_limits<double>::infinity(); });
  refused([](BalProblem& p) { p.points[1].data[0] = std::nan(""); });
  refused([](BalProblem& p) { p.cameras.clear(); });
  refused([](BalProblem& p) { p.points.clear(); });
  refused([](BalProblem& p) { p.observations.clear(); });
}

TEST(Bal, ToAGraphAndBack) {
  TempFiles files;
  const BalProblem problem = ReadBal(files.Write("a", kSmall)).value();
  Graph graph;
  auto handles = AddToGraph(problem, graph, Huber{2.0});
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  EXPECT_EQ(graph.NumVertices<VertexCameraBal>(), 2);
  EXPECT_EQ(graph.NumVertices<VertexPointXYZ>(), 3);
  EXPECT_EQ(graph.NumEdges<EdgeBal>(), 4);
  EXPECT_EQ(graph.Find(handles->edges[2])->uv, Vector2(3.0, 0.04125));
  EXPECT_EQ(graph.VerticesOf(handles->edges[2]).value(),
            (std::vector<AnyVertex>{handles->cameras[1], handles->points[1]}));
  auto back = BalFromGraph(graph);
  ASSERT_TRUE(back.ok());
  EXPECT_TRUE(SameBits(problem, *back));

  // What is removed leaves the numbering without gaps.
  graph.RemoveVertex(handles->cameras[0]);
  graph.RemoveVertex(handles->points[0]);
  back = BalFromGraph(graph);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->cameras.size(), 1u);
  EXPECT_EQ(back->points.size(), 2u);
  EXPECT_EQ(back->observations,
            (std::vector<BalObservation>{{0, 0, 3.0, 0.04125}, {0, 1, 5.0, 6.0}}));
  ASSERT_TRUE(WriteBal(*back, files.Path("b")).ok());
  EXPECT_TRUE(SameBits(*back, *ReadBal(files.Path("b"))));

  EXPECT_EQ(AddToGraph(problem, graph, Huber{-1.0}).status().code(), StatusCode::kNotPositive);
  EXPECT_EQ(graph.NumVertices(), 3);
  ASSERT_TRUE(graph.AddVertex(VertexPose{}).ok());
  EXPECT_EQ(BalFromGraph(graph).status().code(), StatusCode::kInvalidArgument);
}

TEST(Bal, MovedToAGraphItIsTheSame) {
  TempFiles files;
  const BalProblem problem = ReadBal(files.Write("a", kSmall)).value();
  Graph copied, moved;
  ASSERT_TRUE(AddToGraph(problem, copied, Huber{2.0}).ok());
  ASSERT_TRUE(MoveToGraph(BalProblem(problem), moved, Huber{2.0}).ok());
  EXPECT_TRUE(SameBits(problem, *BalFromGraph(moved)));
  EXPECT_EQ(moved.Cost().value(), copied.Cost().value());
  BalProblem bad = problem;
  bad.observations[3].camera = 7;
  EXPECT_EQ(MoveToGraph(std::move(bad), moved).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(MoveToGraph(BalProblem(problem), moved, Huber{-1.0}).code(), StatusCode::kNotPositive);
  EXPECT_EQ(moved.NumVertices(), 5);
  EXPECT_EQ(moved.NumEdges(), 4);
}

TEST(Bal, ProgressOfALongText) {
  TempFiles files;
  BalProblem problem = ReadBal(files.Write("a", kSmall)).value();
  problem.observations.resize(300000, problem.observations[0]);
  std::vector<double> parts;
  ASSERT_TRUE(WriteBal(problem, files.Path("b"), [&](double part) { parts.push_back(part); }).ok());
  ASSERT_GE(parts.size(), 3u);
  EXPECT_GT(parts.front(), 0.0);
  for (std::size_t k = 1; k < parts.size(); ++k)
    EXPECT_GT(parts[k], parts[k - 1]);
  EXPECT_LE(parts.back(), 1.0);
  EXPECT_TRUE(SameBits(problem, *ReadBal(files.Path("b"))));
}

TEST(Bal, PublishedProblems) {
  const std::filesystem::path dir = test::DataDir() / "bal";
  if (!std::filesystem::exists(dir)) GTEST_SKIP() << "no folder " << dir;
  const struct {
    const char* name;
    std::size_t cameras, points, observations;
    double cost;
  } cases[] = {{"ladybug-problem-49-7776-pre.txt.gz", 49, 7776, 31843, 8.509125e5},
               {"trafalgar-problem-21-11315-pre.txt.gz", 21, 11315, 36455, 4.413239e6}};
  for (const auto& expected : cases) {
    const auto start = std::chrono::steady_clock::now();
    const auto problem = ReadBal((dir / expected.name).string());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    ASSERT_TRUE(problem.ok()) << problem.status().message();
    EXPECT_EQ(problem->cameras.size(), expected.cameras);
    EXPECT_EQ(problem->points.size(), expected.points);
    EXPECT_EQ(problem->observations.size(), expected.observations);
    EXPECT_LT(seconds.count(), 2.0);  // 0.02 s on a quiet machine; sanitizers and load excused
    RecordProperty(expected.name, std::to_string(seconds.count()));
    Graph graph;
    ASSERT_TRUE(AddToGraph(*problem, graph).ok());
    // Nothing dropped: points behind their camera count too.
    EXPECT_NEAR(graph.Cost().value(), expected.cost, 5e-7 * expected.cost);
    TempFiles files;
    ASSERT_TRUE(WriteBal(*problem, files.Path("again.txt")).ok());
    EXPECT_TRUE(SameBits(*problem, *ReadBal(files.Path("again.txt"))));
  }
}

}  // namespace
}  // namespace glissade
