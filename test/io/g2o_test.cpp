// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/g2o.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/random_states.h"
#include "io/temp_file.h"

// Files of g2o: what is read, what is refused, what comes back. What the numbers mean:
// g2o_graph_test.cpp.

namespace glissade {
namespace {

const char* const kIdentity6 = "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1";

/// One of each kind, lines 1 to 13.
const std::string kSmall = std::string("# a comment\n") +                                  //
                           "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n" +                          // 2
                           "PARAMS_SE3OFFSET 3 0.1 -.2 +3e-1 0.5 -0.5 0.5 0.5\n" +         // 3
                           "VERTEX_SE3:QUAT 0 1 2 3 0 0 0 1\r\n" +                         // 4
                           "VERTEX_SE3:QUAT 7 1.5 2 3 0 0.1987 0 0.98\n" +                 // 5
                           "VERTEX_TRACKXYZ 9 4 5 6\n" +                                   // 6
                           "VERTEX_XYZ 6989586621679009792 0.1 0.2 8\n" +                  // 7
                           "VERTEX_CAM 2 0 0 0 0 0 0 1 500 501 320 240 0.12\n" +           // 8
                           "FIX 0 9\n" +                                                   // 9
                           "EDGE_SE3:QUAT 0 7  0.5 0 0  0 0.2 0 0.98  " + kIdentity6 +     // 10
                           "\nEDGE_SE3_PRIOR 7 0 1.4 2 3 0 0.2 0 0.98 " + kIdentity6 +     // 11
                           "\nEDGE_SE3_TRACKXYZ 7 9 3 1 2 3  2 0 0 3 0 4\n" +              // 12
                           "EDGE_PROJECT_P2MC 6989586621679009792 2 331.5 250 1 0.5 2\n";  // 13

std::string WithLine(int line, const std::string& replacement) {
  std::string text = kSmall;
  std::size_t begin = 0;
  for (int k = 1; k < line; ++k)
    begin = text.find('\n', begin) + 1;
  return text.replace(begin, text.find('\n', begin) - begin, replacement);
}

TEST(G2o, ReadsEveryKind) {
  TempFiles files;
  for (const std::string& path :
       {files.Write("a.g2o", kSmall), files.WriteCompressed("a.g2o.gz", kSmall),
        files.WriteCompressed("a.g2o.bz2", kSmall)}) {
    EXPECT_TRUE(IsG2o(path));
    const auto problem = ReadG2o(path);
    ASSERT_TRUE(problem.ok()) << problem.status().message();
    ASSERT_EQ(problem->offsets.size(), 2u);
    EXPECT_EQ(problem->offsets[1].id, 3);
    EXPECT_EQ(problem->offsets[1].T_b_s.p(), Vector3(0.1, -0.2, 0.3));
    EXPECT_EQ(problem->offsets[1].T_b_s.data[4], -0.5);
    ASSERT_EQ(problem->poses.size(), 2u);
    EXPECT_TRUE(problem->poses[0].fixed);
    EXPECT_FALSE(problem->poses[1].fixed);
    EXPECT_EQ(problem->poses[1].id, 7);
    EXPECT_EQ(problem->poses[1].T_w_b.data[4], 0.1987);  // as it stands there, not normalized
    ASSERT_EQ(problem->points.size(), 2u);
    EXPECT_EQ(problem->points[0], (G2oPoint{9, {4, 5, 6}, true, false}));
    EXPECT_EQ(problem->points[1], (G2oPoint{6989586621679009792, {0.1, 0.2, 8}, false, true}));
    ASSERT_EQ(problem->cameras.size(), 1u);
    EXPECT_EQ(problem->cameras[0], (G2oCamera{2, Pose(), 500, 501, 320, 240, 0.12, false}));
    ASSERT_EQ(problem->relative_poses.size(), 1u);
    EXPECT_EQ(problem->relative_poses[0].from, 0);
    EXPECT_EQ(problem->relative_poses[0].to, 7);
    EXPECT_EQ(problem->relative_poses[0].information[6], 1.0);
    ASSERT_EQ(problem->priors.size(), 1u);
    EXPECT_EQ(problem->priors[0].T_w_s.p(), Vector3(1.4, 2, 3));
    ASSERT_EQ(problem->point_measurements.size(), 1u);
    EXPECT_EQ(problem->point_measurements[0],
              (G2oPointMeasurement{7, 9, 3, {1, 2, 3}, {2, 0, 0, 3, 0, 4}}));
    ASSERT_EQ(problem->projections.size(), 1u);
    EXPECT_EQ(problem->projections[0],
              (G2oProjection{6989586621679009792, 2, 331.5, 250, {1, 0.5, 2}}));
  }
  // In any order: what is named may come later.
  const std::string backwards = WithLine(2, "") + "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n";
  const auto again = ReadG2o(files.Write("b.g2o", backwards));
  ASSERT_TRUE(again.ok()) << again.status().message();
  EXPECT_EQ(again->offsets[1].id, 0);
  EXPECT_FALSE(IsG2o(files.Write("bal", "1 1 1\n0 0 1 2\n")));
  EXPECT_FALSE(IsG2o(files.Write("empty", "")));
  EXPECT_FALSE(IsG2o(files.Path("none")));
}

TEST(G2o, WhatIsWrongIsNamedWithFileAndLine) {
  TempFiles files;
  const std::string tag = "12: tag 'EDGE_SE2' is not supported; those that are: PARAMS_SE3OFFSET, ";
  const struct {
    int line;
    std::string replacement;
    std::string message;
  } cases[] = {
      {2, "PARAMS_SE3OFFSET 1 0 0 0 0 0 0 1", "11: EDGE_SE3_PRIOR: there is no PARAMS_SE3OFFSET 0"},
      {3, "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1",
       "3: PARAMS_SE3OFFSET: id 0 is there already, in "
       "line 2"},
      {4, "VERTEX_SE3:QUAT 0 1 2 3 0 0 1",
       "4: expected VERTEX_SE3:QUAT id x y z qx qy qz qw: 9 "
       "fields, found 8"},
      {4, "VERTEX_SE3:QUAT -1 1 2 3 0 0 0 1", "4: expected id (an integer from 0 to "},
      {4, "VERTEX_SE3:QUAT 0.5 1 2 3 0 0 0 1", "4: expected id (an integer from 0 to "},
      {4, "VERTEX_SE3:QUAT 0 1 2 3 0 0 0 0", "4: VERTEX_SE3:QUAT: quaternion has norm 0.000000"},
      {4, "VERTEX_SE3:QUAT 0 1 2 nan 0 0 0 1", "4: expected position (a finite number), found 'na"},
      {5, "VERTEX_SE3:QUAT 0 1 2 3 0 0 0 1",
       "5: VERTEX_SE3:QUAT: id 0 is there already, in line "
       "4"},
      {6, "VERTEX_TRACKXYZ 7 1 2 3", "6: VERTEX_TRACKXYZ: id 7 is there already, in line 5"},
      {9, "FIX 0 8", "9: FIX: there is no vertex 8"},
      {9, "FIX", "9: expected vertex (an integer from 0 to "},
      {9, "FIX 0 x", "9: expected vertex (an integer from 0 to "},
      {8, "VERTEX_CAM 2 0 0 0 0 0 0 1", "8: expected VERTEX_CAM id x y z qx qy qz qw fx fy cx cy "},
      {10, std::string("EDGE_SE3:QUAT 0 8 0 0 0 0 0 0 1 ") + kIdentity6,
       "10: EDGE_SE3:QUAT: there is no vertex 8"},
      {10, std::string("EDGE_SE3:QUAT 7 7 0 0 0 0 0 0 1 ") + kIdentity6,
       "10: EDGE_SE3:QUAT: from vertex 7 to itself"},
      {10, std::string("EDGE_SE3:QUAT 0 9 0 0 0 0 0 0 1 ") + kIdentity6,
       "10: EDGE_SE3:QUAT: expected a VERTEX_SE3:QUAT, and vertex 9 is a VERTEX_TRACKXYZ"},
      {10, std::string("EDGE_SE3:QUAT 0 7 0 0 0 0 0 0 1.1 ") + kIdentity6,
       "10: EDGE_SE3:QUAT: quaternion has norm 1.1"},
      {12, "EDGE_SE3_TRACKXYZ 7 9 3 1 2 3  2 0 5 3 0 4",
       "12: EDGE_SE3_TRACKXYZ: information is not positive semi-definite"},
      {12, "EDGE_SE3_TRACKXYZ 7 9 3 1 2 3  2 0 1e999 3 0 4",
       "12: expected information (a finite number), found '1e999'"},
      {12, "EDGE_SE3_TRACKXYZ 7 9 5 1 2 3  2 0 0 3 0 4",
       "12: EDGE_SE3_TRACKXYZ: there is no PARAMS_SE3OFFSET 5"},
      {12, "EDGE_SE2 0 7 1 2 3 1 0 0 1 0 1", tag},
      {13, "EDGE_PROJECT_P2MC 2 9 331.5 250 1 0.5 2",
       "13: EDGE_PROJECT_P2MC: expected a VERTEX_TRACKXYZ, and vertex 2 is a VERTEX_CAM"},
      {13, "EDGE_PROJECT_P2SC 9 2 331.5 250 320 1 0 0 1 0 1",
       "13: tag 'EDGE_PROJECT_P2SC' is not supported"},
  };
  for (const auto& [line, replacement, message] : cases) {
    const std::string path = files.Write("bad.g2o", WithLine(line, replacement));
    const auto problem = ReadG2o(path);
    ASSERT_FALSE(problem.ok()) << message;
    EXPECT_EQ(problem.status().code(), StatusCode::kParseError);
    EXPECT_EQ(problem.status().message().rfind(path + ":" + message, 0), 0u)
        << problem.status().message() << "\n"
        << message;
    EXPECT_EQ(problem.status().message().find('\n'), std::string::npos);
  }
  EXPECT_EQ(ReadG2o(files.Path("none")).status().code(), StatusCode::kIoError);
}

TEST(G2o, WrittenFilesComeBackAsTheSameBits) {
  TempFiles files;
  G2oProblem problem = ReadG2o(files.Write("a", kSmall)).value();
  problem.poses[1].T_w_b.data[0] = 1.0 / 3.0;
  problem.relative_poses[0].information[20] = 1.23456789012345678e-7;
  problem.points[1].fixed = problem.cameras[0].fixed = true;
  for (const char* name : {"b.g2o", "b.g2o.gz", "b.g2o.bz2"}) {
    ASSERT_TRUE(WriteG2o(problem, files.Path(name)).ok());
    const auto again = ReadG2o(files.Path(name));
    ASSERT_TRUE(again.ok()) << again.status().message();
    EXPECT_TRUE(problem == *again) << name;
  }
  // An empty problem is none to solve, and yet a file.
  ASSERT_TRUE(WriteG2o({}, files.Path("empty.g2o")).ok());
  EXPECT_TRUE(ReadG2o(files.Path("empty.g2o")).value() == G2oProblem());
}

TEST(G2o, OtherTagsAreKeptWhereThatIsAskedFor) {
  TempFiles files;
  const std::string text = kSmall + "VERTEX_SE2 100 1 2 3\nFIX 100 2\n" +
                           "EDGE_SE2   100 100 1 2\t3 1 0 0 1 0 1  \nDATA_USER_TAG_ITEM x\n";
  EXPECT_FALSE(ReadG2o(files.Write("a", text)).ok());
  const auto problem = ReadG2o(files.Path("a"), G2oOtherTags::kKeep);
  ASSERT_TRUE(problem.ok()) << problem.status().message();
  EXPECT_EQ(problem->other_lines, (std::vector<std::string>{"VERTEX_SE2 100 1 2 3",
                                                            "EDGE_SE2   100 100 1 2\t3 1 0 0 1 0 1",
                                                            "DATA_USER_TAG_ITEM x", "FIX 100"}));
  EXPECT_TRUE(problem->cameras[0].fixed);
  ASSERT_TRUE(WriteG2o(*problem, files.Path("b")).ok());
  const auto again = ReadG2o(files.Path("b"), G2oOtherTags::kKeep);
  ASSERT_TRUE(again.ok()) << again.status().message();
  // Vertices come before edges, else in the order they had.
  EXPECT_EQ(again->other_lines,
            (std::vector<std::string>{"VERTEX_SE2 100 1 2 3", "DATA_USER_TAG_ITEM x",
                                      "EDGE_SE2   100 100 1 2\t3 1 0 0 1 0 1", "FIX 100"}));
}

TEST(G2o, NothingIsWrittenThatCannotBeRead) {
  TempFiles files;
  const G2oProblem good = ReadG2o(files.Write("a", kSmall)).value();
  const auto refused = [&](const char* what, auto&& spoil) {
    G2oProblem bad = good;
    spoil(bad);
    const Status status = WriteG2o(bad, files.Path("bad"));
    EXPECT_FALSE(status.ok()) << what;
    EXPECT_NE(status.message().find(what), std::string::npos) << status.message();
    EXPECT_EQ(files.Count(), 1);
    Graph graph;
    if (bad.other_lines.empty()) {
      EXPECT_FALSE(AddToGraph(bad, graph).ok());
    }
    EXPECT_EQ(graph.NumVertices() + graph.NumEdges(), 0);
  };
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  refused("EDGE_SE3:QUAT 0: there is no vertex 5",
          [](G2oProblem& p) { p.relative_poses[0].to = 5; });
  refused("VERTEX_SE3:QUAT 1: a number", [&](G2oProblem& p) { p.poses[1].T_w_b.data[2] = nan; });
  refused("VERTEX_CAM 0: a number", [&](G2oProblem& p) { p.cameras[0].cx = inf; });
  refused("VERTEX_TRACKXYZ 1: a number", [&](G2oProblem& p) { p.points[1].xyz[2] = nan; });
  refused("EDGE_SE3_TRACKXYZ 0: a number",
          [&](G2oProblem& p) { p.point_measurements[0].information[1] = nan; });
  refused("information is not positive", [](G2oProblem& p) { p.priors[0].information[0] = -1; });
  refused("id -4 is negative", [](G2oProblem& p) { p.poses[0].id = -4; });
  for (const char* line : {"", " x", "# x", "x\ny", "x "})
    refused("other line 0", [&](G2oProblem& p) { p.other_lines = {line}; });
}

/// Reads what may be anything: a refusal with the file's name, or a problem that can be written and
/// read again, and whose graph has a cost or a status.
void ExpectTotal(const TempFiles& files, const std::string& text, int* read) {
  const std::string path = files.Write("fuzz", text);
  const auto problem = ReadG2o(path, G2oOtherTags::kKeep);
  if (!problem.ok()) {
    EXPECT_EQ(problem.status().code(), StatusCode::kParseError);
    EXPECT_EQ(problem.status().message().rfind(path + ":", 0), 0u) << problem.status().message();
    return;
  }
  ++*read;
  ASSERT_TRUE(WriteG2o(*problem, files.Path("again")).ok()) << text;
  const auto again = ReadG2o(files.Path("again"), G2oOtherTags::kKeep);
  ASSERT_TRUE(again.ok()) << again.status().message() << "\n" << text;
  EXPECT_TRUE(again->relative_poses == problem->relative_poses && again->poses == problem->poses);
  Graph graph;
  if (!AddToGraph(*problem, graph).ok()) {
    EXPECT_EQ(graph.NumVertices() + graph.NumEdges(), 0);
    return;
  }
  const auto cost = graph.Cost();
  EXPECT_TRUE(!cost.ok() || std::isfinite(*cost)) << text;
}

TEST(G2o, AnyPrefixAndAnyMutationIsReadOrRefused) {
  TempFiles files;
  int read = 0;
  for (std::size_t size = 0; size < kSmall.size(); size += 3)
    ExpectTotal(files, kSmall.substr(0, size), &read);
  test::Random random(5);
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(random.Uniform(0.0, static_cast<double>(n)));
  };
  const std::string alphabet = "0123456789.-+eEnaif \t\n\r#:_QX\xff";
  for (int trial = 0; trial < 600; ++trial) {
    std::string text = kSmall;
    for (std::size_t k = below(4) + 1; k > 0; --k) {
      const std::size_t at = below(text.size());
      switch (below(4)) {
        case 0:
          text[at] = alphabet[below(alphabet.size())];
          break;
        case 1:
          text.insert(at, 1, alphabet[below(alphabet.size())]);
          break;
        case 2:
          text.erase(at, below(12));
          break;
        default:  // a piece from elsewhere
          text.insert(at, text.substr(below(text.size()), below(40)));
      }
    }
    ExpectTotal(files, text, &read);
  }
  EXPECT_GT(read, 50);
}

}  // namespace
}  // namespace glissade
